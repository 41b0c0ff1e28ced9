"""What a person does is told from markers without names: synthetic motions and real captures."""

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.io.capture import read_capture
from mbkf.io.records import MarkerTrajectories
from mbkf.io.session import TrialKind
from mbkf.study.survey.body_points import BodyPoints
from mbkf.study.survey.movement import climbs, kind_of_markers, kind_of_movement, passes, turned_deg
from mbkf.trial.synth import synthesise

RATE_HZ = 100.0


@pytest.mark.parametrize(
    ("motion", "seed", "kind"),
    [
        ("walk", 1, TrialKind.WALK),
        ("squat", 5, TrialKind.SQUAT),
        ("jump", 1, TrialKind.JUMP),
        ("reach", 5, TrialKind.UNKNOWN),
        ("turn", 5, TrialKind.TURN),
        ("step_up", 5, TrialKind.STAIRS),
        ("kneel", 5, TrialKind.UNKNOWN),
        ("star_arc", 5, TrialKind.UNKNOWN),
    ],
)
def test_synthetic_motions(motion, seed, kind):
    """The floor may be at any height."""
    _, made = synthesise(motion, seconds=8.0 if motion in ("kneel", "star_arc") else 4.0, seed=seed)
    assert kind_of_markers(made.trial.markers) == kind
    assert kind_of_markers(made.static.markers) == TrialKind.STATIC
    names = tuple(f"*{k}" for k in range(len(made.trial.markers.names)))
    for floor_m in (0.0, 3.0):
        raised = made.trial.markers.positions_m + np.array([0.0, 0.0, floor_m])
        assert kind_of_markers(MarkerTrajectories(names, raised, 100.0)) == kind


@pytest.mark.parametrize(
    ("file", "kind"),
    [
        ("rajagopal_walk_run/motion_capture_walk.trc", TrialKind.WALK),
        ("rajagopal_walk_run/motion_capture_run.trc", TrialKind.RUN),
        ("rajagopal_walk_run/static_walk_1.trc", TrialKind.STATIC),
        ("bmc_walk_run/run.trc", TrialKind.RUN),
        ("cgm24_lowerlimb_walk/CGM24_Walking01.c3d", TrialKind.WALK),
        ("biobuddy_functional/functional_right_knee.c3d", TrialKind.UNKNOWN),
        ("stoop_lift_box/stoop2_t169_f1395f1590.c3d", TrialKind.UNKNOWN),
    ],
)
def test_real_captures(real_data, file, kind):
    assert kind_of_markers(read_capture(real_data / file).markers) == kind


def test_no_marker_tells_nothing():
    markers = MarkerTrajectories(("A", "B"), np.full((10, 2, 3), np.nan), RATE_HZ)
    assert kind_of_markers(markers) == TrialKind.UNKNOWN


def body(feet_m, lifts_m, pelvis_m, yaw_rad=0.0):
    """Points of a body that faces one direction, or the one given."""
    frames = len(pelvis_m)
    return BodyPoints(feet_m, lifts_m, pelvis_m, np.zeros(frames) + yaw_rad)


def gait(flight, seconds=4.0, cycle_s=1.0):
    """Feet that pass each other; both leave the floor for a share of each step."""
    t = np.arange(int(seconds * RATE_HZ)) / RATE_HZ
    along = 0.4 * np.cos(2 * np.pi * t / cycle_s)
    feet = np.zeros((len(t), 2, 3))
    feet[:, 0, 0], feet[:, 1, 0] = along, -along
    step = (t / (0.5 * cycle_s)) % 1.0
    airborne = step < flight
    rise = np.where(airborne, 0.1, 0.0)
    lifts = np.stack([rise + 0.05 * (along > 0), rise + 0.05 * (along < 0)], axis=1)
    fallen = step * 0.5 * cycle_s
    height = 1.0 + np.where(airborne, 0.5 * GRAVITY_M_S2 * fallen * (flight * 0.5 * cycle_s - fallen), 0.0)
    pelvis = np.stack([t, 0 * t, height], axis=1)
    return body(feet, lifts, pelvis)


def test_flight_makes_a_run():
    assert passes(gait(0.0)) == 8
    assert kind_of_movement(gait(0.0), RATE_HZ) == TrialKind.WALK
    assert kind_of_movement(gait(0.35), RATE_HZ) == TrialKind.RUN


def test_who_stands_on_a_step_does_not_fly():
    walk = gait(0.0)
    lifts = walk.lifts_m + np.where(np.arange(len(walk.lifts_m)) > 200, 0.2, 0.0)[:, None]
    still = body(np.zeros_like(walk.feet_m), lifts, walk.pelvis_m)
    assert kind_of_movement(still, RATE_HZ) == TrialKind.UNKNOWN


def test_a_walk_that_changes_its_direction_turns():
    """The pelvis swings by 20° about its direction in every stride; only the direction's change counts."""
    walk = gait(0.0)
    t = np.arange(len(walk.pelvis_m)) / RATE_HZ
    for final_deg, kind in ((30.0, TrialKind.WALK), (90.0, TrialKind.TURN)):
        yaw = np.radians(20.0 * np.sin(2 * np.pi * t) + final_deg * np.clip(t - 1.5, 0.0, 1.0))
        turning = body(walk.feet_m, walk.lifts_m, walk.pelvis_m, yaw)
        assert abs(turned_deg(turning, RATE_HZ) - final_deg) < 8.0
        assert kind_of_movement(turning, RATE_HZ) == kind


def test_a_foot_that_stands_higher_climbs_only_if_the_pelvis_follows():
    """One foot is put 0.2 m higher for the second half; the pelvis rises, or stays as in standing on one foot."""
    frames = 400
    lifts = np.zeros((frames, 2))
    lifts[200:, 0] = 0.2
    feet = np.zeros((frames, 2, 3))
    for rise, found in ((0.2, True), (0.0, False)):
        pelvis = np.tile([0.0, 0.0, 1.0], (frames, 1))
        pelvis[250:, 2] += rise
        assert climbs(body(feet, lifts, pelvis), RATE_HZ) is found


def test_who_sinks_over_straight_legs_stoops():
    """Feet stay and the pelvis sinks by 0.3 m; only knees that go forward with it make a squat."""
    frames = 300
    sinking = 0.15 * (1.0 - np.cos(2 * np.pi * np.arange(frames) / frames))
    pelvis = np.column_stack([np.zeros(frames), np.zeros(frames), 1.0 - sinking])
    feet, lifts = np.zeros((frames, 2, 3)), np.zeros((frames, 2))
    for travel, kind in ((0.3, TrialKind.SQUAT), (0.1, TrialKind.UNKNOWN), (np.nan, TrialKind.SQUAT)):
        found = BodyPoints(feet, lifts, pelvis, np.zeros(frames), travel)
        assert kind_of_movement(found, RATE_HZ) == kind


def test_one_foot_that_reaches_around_does_not_walk():
    """Feet pass each other, but one of them stands all the time and the pelvis stays."""
    walk = gait(0.0)
    feet = 2.0 * walk.feet_m
    feet[:, 1] = 0.0
    pelvis = np.tile([0.0, 0.0, 1.0], (len(feet), 1))
    assert kind_of_movement(body(feet, walk.lifts_m, pelvis), RATE_HZ) == TrialKind.UNKNOWN
