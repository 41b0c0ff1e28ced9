"""Far markers are missing, plates of impossible forces left out, impossible rates refused; the rest stays."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.capture import read_capture
from mbkf.io.plausible import plausible
from mbkf.io.records import Capture, MarkerTrajectories, PlateReadings
from tests.io.c3d_builder import Plate, build_c3d, standing_points

MARKERS = MarkerTrajectories(("A", "B"), np.ones((5, 2, 3)), 100.0)
PLATE = PlateReadings(
    "1", 1000.0, 0.0, np.zeros(3), np.zeros((50, 3)), np.zeros((50, 3)), np.full((50, 3), np.nan), 20.0
)


def test_what_is_measured_stays_as_it_is():
    capture = Capture("x", MARKERS, (PLATE,))
    assert plausible(capture) is capture
    assert plausible(Capture("x", MarkerTrajectories((), np.zeros((3, 0, 3)), 100.0))).markers.frames == 3


def test_far_samples_are_missing_and_told():
    positions = np.ones((5, 2, 3))
    positions[2, 1, 0], positions[3, 1] = 1e9, np.inf
    found = plausible(Capture("x", replace(MARKERS, positions_m=positions), notes=("before",)))
    np.testing.assert_array_equal(
        found.markers.present, [[True] * 2] * 2 + [[True, False]] * 2 + [[True] * 2]
    )
    assert found.notes[0] == "before" and "2 samples lie more than 1000 m away" in found.notes[1]


@pytest.mark.parametrize("what", ["force_n", "moment_nm"])
def test_a_plate_with_impossible_loads_is_left_out(what):
    values = np.zeros((50, 3))
    values[7, 1] = -1.3e6
    wrong, right = replace(PLATE, **{what: values}), replace(PLATE, name="2")
    found = plausible(Capture("x", MARKERS, (wrong, right), plates_left_out={"3": "silent"}))
    assert found.plates == (right,) and list(found.plates_left_out) == ["3", "1"]
    assert len(found.notes) == 1
    assert re.match(r"force plate 1 is left out: it reads a (force|moment) of 1.3e\+06", found.notes[0])
    with pytest.raises(InvalidInput, match=r"grf\.mot: force plate 1 reads"):
        plausible(Capture("x", MARKERS, (wrong,)), Path("grf.mot"))


@pytest.mark.parametrize("rate_hz", [1e-3, 1e7])
def test_impossible_rates_are_refused(rate_hz):
    with pytest.raises(InvalidInput, match="rate"):
        plausible(Capture("x", replace(MARKERS, rate_hz=rate_hz)))


def test_far_samples_are_missing_before_persons_are_sought(tmp_path):
    points = [[10.0 * k, 20.0 * k, 5.0 * k] for k in range(1, 25)]
    points[3][1] = 1e200
    rows = [[t, t / 100.0, *np.ravel(points)] for t in range(4)]
    path = tmp_path / "x.trc"
    names = "\t\t\t".join(f"M{k}" for k in range(24))
    path.write_text(
        "PathFileType\t4\t(X/Y/Z)\tx.trc\n"
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n100\t100\t4\t24\tmm\n"
        f"Frame#\tTime\t{names}\n\t\tX1\tY1\tZ1\n" + "".join("\t".join(map(str, row)) + "\n" for row in rows)
    )
    assert read_capture(path).markers.present[0].sum() == 23


def test_a_file_is_read_that_way(tmp_path):
    points = standing_points(20)
    points[3, 2] = 1e9
    path = build_c3d(tmp_path / "x.c3d", points)
    found = read_capture(path)
    assert not found.markers.present[3, 2] and any("1000 m" in note for note in found.notes)
    channels = np.zeros((20, 6))
    channels[5, 2] = -2e6
    path = build_c3d(tmp_path / "y.c3d", standing_points(20), plates=(Plate(2, channels),))
    found = read_capture(path)
    assert found.plates == () and "--forces" in found.notes[-1]
