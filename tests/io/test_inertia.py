"""A person's own inertial parameters in the subject file: read back as written; what is no body is refused."""

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.inertia import SegmentInertia
from mbkf.io.subject import Subject, read_subject, write_subject

PLAIN = Subject("human18", 70.0, {"head": 1.05}, (), "reference36")
VECTOR = st.lists(st.floats(-0.1, 0.1), min_size=3, max_size=3).map(np.array)
OWN = st.builds(
    SegmentInertia,
    mass_factor=st.floats(0.1, 3.0),
    centre_shift_m=VECTOR,
    mass_factor_sd=st.floats(0.0, 1.0),
    centre_shift_sd_m=VECTOR,
)


def numbers(inertia):
    return {
        name: (own.mass_factor, own.mass_factor_sd, *own.centre_shift_m, *own.centre_shift_sd_m)
        for name, own in inertia.items()
    }


@settings(max_examples=25, deadline=None)
@given(st.dictionaries(st.sampled_from(["pelvis", "torso", "right_thigh"]), OWN))
def test_what_is_written_is_read(inertia):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "subject.toml"
        write_subject(replace(PLAIN, inertia=inertia), path)
        assert numbers(read_subject(path).inertia) == numbers(inertia)
        assert ("[inertia" in path.read_text()) == bool(inertia)


@pytest.mark.parametrize("wrong", [{"mass_factor": 0.0}, {"mass_factor": np.nan}, {"mass_factor_sd": np.inf}])
def test_no_body_has_such_segments(wrong):
    with pytest.raises(InvalidInput):
        SegmentInertia(**wrong)


def test_a_shift_has_three_coordinates(tmp_path):
    path = tmp_path / "subject.toml"
    write_subject(replace(PLAIN, inertia={"torso": SegmentInertia(1.1)}), path)
    path.write_text(path.read_text().replace("centre_shift_m = [0.0, 0.0, 0.0]", "centre_shift_m = [0.0]"))
    with pytest.raises(FileFormatError, match="inertia torso: centre_shift_m must be 3 numbers"):
        read_subject(path)
