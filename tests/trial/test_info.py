"""The summary counts what was put in."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.records import (
    AnalogChannel,
    AxesSource,
    Capture,
    CaptureEvent,
    DerivedPoint,
    MarkerTrajectories,
    PlateReadings,
)
from mbkf.io.turning import turned
from mbkf.trial.info import AxesSummary, describe
from tests.captures import made_capture


def capture() -> Capture:
    positions = np.ones((10, 3, 3)) * [[0.0, 0.1, 1.0], [0.2, -0.3, 1.5], [0.4, 0.0, 0.1]]
    positions[2:5, 1] = np.nan
    force = np.zeros((100, 3))
    force[20:45, 2] = 100.0
    force[30, 2] = 750.0
    plate = PlateReadings("2", 1000.0, 1.0, np.zeros(3), force, 0 * force, 0 * force, 20.0,
                          np.arange(12.0).reshape(4, 3), np.array([0, 0, -16.5, 0, 0, 0.0]))  # fmt: skip
    nothing = np.zeros((10, 3))
    return Capture(
        "walk.c3d", MarkerTrajectories(("LASI", "RASI", "*2"), positions, 100.0, 1.0), (plate,),
        (DerivedPoint("A", "angle", nothing, "deg"), DerivedPoint("B", "angle", nothing, "deg")),
        (AnalogChannel("EMG", np.zeros(100), "V", 1000.0),), (CaptureEvent("Foot Off", "Left", 1.05),),
        notes=("remark",), subject_mass_kg=70.0,
    )  # fmt: skip


def test_counts_shares_and_ranges():
    summary = describe(capture())
    assert (summary.frames, summary.rate_hz, summary.start_time_s, summary.duration_s) == (
        10,
        100.0,
        1.0,
        0.1,
    )
    assert (summary.labelled, summary.unlabelled) == (2, 1)
    assert summary.missing_fraction == pytest.approx(0.1)
    assert summary.extent_m == ((0.0, -0.3, 0.1), (0.4, 0.1, 1.5))
    assert [(m.name, m.pieces) for m in summary.markers] == [("LASI", 1), ("RASI", 2), ("*2", 1)]
    np.testing.assert_allclose([m.missing_fraction for m in summary.markers], [0.0, 0.3, 0.0])
    (plate,) = summary.plates
    assert (plate.name, plate.offset_n, plate.peak_n, plate.loaded_fraction) == ("2", -16.5, 750.0, 0.25)
    assert plate.corners_m[3] == (9.0, 10.0, 11.0)
    assert (plate.rate_hz, plate.duration_s) == (1000.0, 0.1)
    assert summary.derived == {"angle": 2}
    assert [(c.name, c.unit, c.rate_hz) for c in summary.channels] == [("EMG", "V", 1000.0)]
    assert (summary.events, summary.notes, summary.subject_mass_kg) == (capture().events, ("remark",), 70.0)


def test_a_capture_in_which_nothing_was_seen():
    summary = describe(Capture("", MarkerTrajectories(("A",), np.full((4, 1, 3), np.nan), 50.0)))
    assert (summary.extent_m, summary.missing_fraction, summary.markers[0].pieces) == (None, 1.0, 0)
    empty = describe(Capture("", MarkerTrajectories((), np.zeros((0, 0, 3)), 50.0)))
    assert (empty.frames, empty.duration_s, empty.missing_fraction) == (0, 0.0, 0.0)


def test_the_protocol_is_told_with_how_much_it_knows():
    made = made_capture(4)
    assert describe(capture()).protocol is None
    whole = describe(made).protocol
    assert (whole.name, whole.known, whole.markers, whole.share, whole.accepted) == (
        "reference36",
        36,
        36,
        1.0,
        True,
    )
    names = tuple(name if i < 10 else f"X{i}" for i, name in enumerate(made.markers.names))
    few = describe(replace(made, markers=replace(made.markers, names=names))).protocol
    assert (few.name, few.known, few.accepted) == ("inferred", 36, True)
    assert few.told.startswith("marker set inferred: 36 markers")


def test_too_few_known_markers_without_a_person_are_told():
    names = (*made_capture(1).markers.names[:10], *(f"X{i}" for i in range(26)))
    nobody = MarkerTrajectories(names, np.zeros((3, 36, 3)), 100.0)
    few = describe(Capture("", nobody)).protocol
    assert (few.known, few.markers, few.accepted, few.told) == (10, 36, False, "")
    assert set(few.ignored) == set(names[10:])


def test_axes_are_told_with_what_the_body_says():
    right = made_capture(10, plates=(), axes_source=AxesSource.DEFAULT)
    assert describe(right).axes == AxesSummary("x,y,z", "default", "right", "x,y,z", "")
    mirrored = replace(turned(right, np.diag([1.0, -1.0, 1.0]), AxesSource.DEFAULT), axes="x,y,z")
    found = describe(mirrored).axes
    assert (found.verdict, found.read, found.used) == ("put right", "x,y,z", "x,-y,z")
    assert "right markers lay left" in found.note
    assert describe(capture()).axes.verdict == "unknown"
