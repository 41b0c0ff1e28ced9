"""Names of points by the headers of captures, the same as reading gives."""

import numpy as np
import pytest

from mbkf.io.c3d_write import write_c3d
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.stated_markers import stated_markers
from mbkf.io.trc import write_trc

NAMES = ("LASI", "RASI", "C7")


@pytest.mark.parametrize("suffix", [".c3d", ".trc"])
@pytest.mark.parametrize("subject", ["", "Anna:"])
def test_names_are_those_of_the_file_without_the_subject(tmp_path, suffix, subject):
    names = tuple(f"{subject}{name}" for name in NAMES)
    markers = MarkerTrajectories(names, np.ones((4, 3, 3)), 100.0)
    path = tmp_path / f"walk{suffix}"
    write_c3d(Capture("", markers), path) if suffix == ".c3d" else write_trc(markers, path)
    assert stated_markers(path) == frozenset(NAMES)
    changed = MarkerTrajectories(names[:2], np.ones((4, 2, 3)), 100.0)
    write_c3d(Capture("", changed), path) if suffix == ".c3d" else write_trc(changed, path)
    assert stated_markers(path) == frozenset(NAMES[:2])


def test_a_file_that_cannot_be_read_states_nothing(tmp_path):
    for name, content in (("a.c3d", b"nothing"), ("a.trc", b""), ("a.mot", b"x")):
        (tmp_path / name).write_bytes(content)
        assert stated_markers(tmp_path / name) == frozenset()
    assert stated_markers(tmp_path / "gone.c3d") == frozenset()
