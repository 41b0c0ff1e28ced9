"""What a person does is told from markers without names: synthetic motions and real captures."""

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.io.capture import read_capture
from mbkf.io.records import MarkerTrajectories
from mbkf.io.session import TrialKind
from mbkf.study.survey.movement import FeetAndPelvis, kind_of_markers, kind_of_movement, passes
from mbkf.trial.synth import synthesise

RATE_HZ = 100.0


@pytest.mark.parametrize(
    ("motion", "seed", "kind"),
    [
        ("walk", 1, TrialKind.WALK),
        ("squat", 5, TrialKind.SQUAT),
        ("jump", 1, TrialKind.JUMP),
        ("reach", 5, TrialKind.UNKNOWN),
    ],
)
def test_synthetic_motions(motion, seed, kind):
    """The floor may be at any height."""
    _, made = synthesise(motion, seconds=3.0, seed=seed)
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
    ],
)
def test_real_captures(real_data, file, kind):
    assert kind_of_markers(read_capture(real_data / file).markers) == kind


def test_no_marker_tells_nothing():
    markers = MarkerTrajectories(("A", "B"), np.full((10, 2, 3), np.nan), RATE_HZ)
    assert kind_of_markers(markers) == TrialKind.UNKNOWN


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
    return FeetAndPelvis(feet, lifts, pelvis)


def test_flight_makes_a_run():
    assert passes(gait(0.0)) == 8
    assert kind_of_movement(gait(0.0), RATE_HZ) == TrialKind.WALK
    assert kind_of_movement(gait(0.35), RATE_HZ) == TrialKind.RUN


def test_who_stands_on_a_step_does_not_fly():
    body = gait(0.0)
    lifts = body.lifts_m + np.where(np.arange(len(body.lifts_m)) > 200, 0.2, 0.0)[:, None]
    still = FeetAndPelvis(np.zeros_like(body.feet_m), lifts, body.pelvis_m)
    assert kind_of_movement(still, RATE_HZ) == TrialKind.UNKNOWN
