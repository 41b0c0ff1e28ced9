"""Rows on direction: captures turn as a whole, the markers' plane is Plug-in Gait's, bounds are where they count."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.any_capture.direction import (
    SIGNS,
    against,
    bent,
    in_marker_plane,
    largest_change,
    plug_in_gait_pelvis,
    turned,
)
from mbkf.errors import UnknownName
from mbkf.io.records import Capture, DerivedPoint, MarkerTrajectories
from mbkf.io.subject import SubjectMarker
from mbkf.io.wrench import centre_of_pressure
from tests.recordings import walk
from tests.walker import walker

TIMES = np.arange(200) / 100.0


def test_a_capture_turns_with_its_plates():
    made = walker()
    quarter = turned(made.trial, 90.0)
    x, y, z = np.moveaxis(made.trial.markers.positions_m, 2, 0)
    np.testing.assert_allclose(quarter.markers.positions_m, np.stack([-y, x, z], axis=2), atol=1e-12)
    for before, plate in zip(made.trial.plates, quarter.plates, strict=True):
        up = np.array([0.0, 0.0, 1.0])
        found = centre_of_pressure(plate.force_n, plate.moment_nm, plate.origin_m, up, plate.threshold_n)
        np.testing.assert_allclose(found, plate.centre_of_pressure_m, atol=1e-9)
        np.testing.assert_allclose(np.linalg.norm(plate.force_n), np.linalg.norm(before.force_n))
    back = turned(quarter, -90.0)
    np.testing.assert_allclose(back.markers.positions_m, made.trial.markers.positions_m, atol=1e-12)


def test_in_a_plane_along_the_bodys_axes_the_angles_are_its_own():
    """A pelvis whose markers lie in its own horizontal plane, walking along x and along another heading."""
    r = walk()
    places = {"LASI": [0.1, 0.12, 0.05], "RASI": [0.1, -0.12, 0.05], "SACR": [-0.08, 0.0, 0.05]}
    markers = tuple(SubjectMarker(n, "pelvis", np.array(at), 0.005, 0.002) for n, at in places.items())
    subject = replace(r.subject, markers=markers)
    found = in_marker_plane(replace(r, subject=subject, heading_rad=np.zeros(r.frames)))
    own = np.column_stack([sign * r.angle(name) for name, sign in SIGNS.items()])
    np.testing.assert_allclose(found, own, atol=1e-9)
    tilted = tuple(
        replace(m, position_m=m.position_m - [0, 0, 0.03]) if m.name == "SACR" else m for m in markers
    )
    lower = in_marker_plane(
        replace(r, subject=replace(subject, markers=tilted), heading_rad=np.zeros(r.frames))
    )
    assert np.mean(found[:, 0] - lower[:, 0]) == pytest.approx(np.arctan2(0.03, 0.18), abs=0.01)


def test_a_bent_walk_keeps_its_speed_and_turns_by_a_quarter():
    r = walk()
    along = replace(r, heading_rad=np.zeros(r.frames))
    q = bent(along)
    np.testing.assert_array_equal(q[:, 7:], r.q[:, 7:])
    np.testing.assert_array_equal(q[:, 2], r.q[:, 2])
    steps = np.linalg.norm(np.diff(q[:, :2], axis=0), axis=1)
    np.testing.assert_allclose(steps, np.linalg.norm(np.diff(r.q[:, :2], axis=0), axis=1), rtol=0.1)
    first, last = q[10, :2] - q[0, :2], q[-1, :2] - q[-11, :2]
    turned_by = np.arctan2(first[0] * last[1] - first[1] * last[0], first @ last)
    assert turned_by == pytest.approx(np.pi / 2, abs=0.25)


def test_the_change_counts_angles_without_whole_turns():
    r = walk()
    angles = np.array(r.angles)
    angles[:, r.coordinate_names.index("pelvis_rotation")] += 2.0 * np.pi
    angles[:, r.coordinate_names.index("pelvis_tx")] += 1.0
    angles[3, r.coordinate_names.index("knee_angle_r")] += 1e-3
    assert largest_change(r, replace(r, angles=angles)) == pytest.approx(1e-3)


def test_the_correlation_is_bounded_where_the_reference_moves():
    swing = np.sin(2.0 * np.pi * TIMES)
    theirs = np.column_stack([1.0 * swing, 3.0 * swing, 3.0 * swing])
    rows = list(against("who", TIMES, theirs + [5.0, 0.0, 0.0] + [0.0, 0.0, 4.0] * swing[:, None], theirs))
    assert [row.bounded for row in rows] == [False, True, True, True, True, True]
    assert [row.passed for row in rows] == [True, True, True, True, True, False]
    assert rows[-1].value == pytest.approx(4.0 / np.sqrt(2.0), rel=1e-2)


def test_a_file_without_plug_in_gait_is_refused():
    markers = MarkerTrajectories(("A",), np.zeros((2, 1, 3)), 100.0)
    angles = DerivedPoint("LPelvisAngles", "angle", np.ones((2, 3)), "deg")
    assert plug_in_gait_pelvis(Capture("walk.c3d", markers, derived=(angles,))).shape == (2, 3)
    with pytest.raises(UnknownName, match="LPelvisAngles"):
        plug_in_gait_pelvis(Capture("walk.c3d", markers))
