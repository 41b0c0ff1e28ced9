"""A functional trial: every large joint of the free leg turns, in the air, and the arms move."""

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.model.clinical import ClinicalAngles
from mbkf.synthesis.star_arc import star_arc_plan


def span_deg(body, motion, name):
    reading = ClinicalAngles(body)
    angles = np.rad2deg(reading.angles(np.asarray(motion.q))[:, reading.names.index(name)])
    return float(np.ptp(angles))


@pytest.mark.slow
def test_hip_knee_ankle_and_arms_turn_far(body, motions):
    motion = motions["star_arc"]
    free = "r" if motion.foot_wrench[:, 0, 2].min() == 0.0 else "l"
    for name, least in (("hip_flexion", 40.0), ("hip_adduction", 20.0), ("ankle_angle", 20.0)):
        assert span_deg(body, motion, f"{name}_{free}") > least
    assert span_deg(body, motion, f"arm_flex_{free}") > 50.0
    assert span_deg(body, motion, f"elbow_flex_{free}") > 50.0


@pytest.mark.parametrize(("seconds", "legs"), [(24.0, 2), (12.0, 1), (6.0, 1)])
def test_what_there_is_time_for_is_done(body, seconds, legs):
    plan = star_arc_plan(body, seconds, np.random.default_rng(1))
    times = np.linspace(0.0, seconds, round(50 * seconds))
    feet = plan.feet(times)
    raised = [side for side, foot in feet.items() if np.ptp(foot.ankle.value[:, 2]) > 0.1]
    assert len(raised) == legs
    for side in raised:
        height = feet[side].ankle.value[:, 2]
        assert height.min() > height[0] - 1e-3  # never below where it stands
        assert feet[side].roll is not None and np.ptp(feet[side].roll.value) > np.deg2rad(20.0)
        bent = plan.angles[f"{'right' if side == 'r' else 'left'}_forearm"][1](times).value
        assert np.ptp(bent) > np.deg2rad(50.0)


def test_a_time_too_short_for_one_star_is_refused(body):
    with pytest.raises(InvalidInput, match="star of one leg"):
        star_arc_plan(body, 5.0, np.random.default_rng(1))
