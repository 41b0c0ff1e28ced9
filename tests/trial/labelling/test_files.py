"""Labelled files and what stands beside them."""

import json

import numpy as np
import pytest

from mbkf.io.capture import read_capture
from mbkf.labelling.assignment import HIDDEN
from mbkf.trial.labelling.files import write_labels
from mbkf.trial.labelling.result import Labelling
from tests.walker import walker


@pytest.mark.parametrize("ending", ["c3d", "trc"])
def test_the_file_holds_the_markers_that_are_shown_and_the_summary_stands_beside_it(tmp_path, ending):
    made = walker()
    markers = made.trial.markers
    positions = markers.positions_m.copy()
    positions[:, 3] = np.nan
    frames, columns = made.raw.markers.positions_m.shape[:2]
    found = Labelling(
        type(markers)(markers.names, positions, markers.rate_hz),
        np.full((frames, columns), HIDDEN),
        np.full(frames, 2),
        (0,),
        0,
        np.full(frames, np.nan),
    )
    path = tmp_path / f"walk.{ending}"
    summary = write_labels(made.raw, found, path)
    back = read_capture(path).markers
    assert set(back.names) == set(markers.names) - {markers.names[3]}
    shown = back.positions_m[:, back.names.index(markers.names[0])]
    assert np.allclose(shown, positions[:, 0], atol=1e-5, equal_nan=True)
    assert json.loads(path.with_suffix(".json").read_text()) == summary
    assert summary["ghosts_dropped"] == 2 * frames
    assert "correct_fraction" not in summary
