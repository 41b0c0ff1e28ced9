"""Cycles of a trial: the reconstruction's numbers over each cycle, per kg, with the midline as each side sees it."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.io.contacts import Source
from mbkf.io.verdict import Reason, Verdict
from mbkf.model.human import reference_body
from mbkf.study.session.cycles import Key, cycles_of_trial, part_of_curve, together
from mbkf.trial.gait.curves import mirrored_midline
from mbkf.trial.gait.cycles import find_gait, over_cycle
from tests.study.session.sessions import estimated, walks


def trial():
    return walks()[1]


@cache
def gait():
    return find_gait(trial())


@pytest.fixture(params=[0, 1], ids=["right", "left"])
def side(request):
    return cycles_of_trial(trial(), gait(), request.param)


def test_every_cycle_is_there_with_the_trials_own_numbers(side):
    own, mass = "rl"[side.side], trial().subject.mass_kg
    assert [one.cycle for one in side.cycles] == list(gait().of(side.side)) and side.cycles
    for k, one in enumerate(side.cycles):

        def over(values, cycle=one.cycle):
            return over_cycle(trial().times_s, values, cycle)

        knee = side.curves[Key("angle", "knee_angle")]
        np.testing.assert_allclose(knee.values[k], over(np.rad2deg(trial().angle(f"knee_angle_{own}"))))
        np.testing.assert_allclose(knee.sd[k], np.rad2deg(0.02))
        torque = side.curves[Key("torque", "knee_angle")]
        np.testing.assert_allclose(torque.values[k], over(trial().moment(f"knee_angle_{own}")) / mass)
        upward = side.curves[Key("reaction", "upward")]
        weight = mass * GRAVITY_M_S2
        np.testing.assert_allclose(
            upward.values[k], over(100.0 * trial().foot_wrench[:, side.side, 2] / weight)
        )
    assert (knee.unit, torque.unit, upward.unit) == ("deg", "N m/kg", "% BW")


def test_the_power_of_a_joint_is_the_sum_over_its_angles(side):
    names = ("hip_flexion", "hip_adduction", "hip_rotation")
    parts = [side.curves[Key("power", name)] for name in names]
    whole = side.curves[Key("power", "hip")]
    np.testing.assert_allclose(whole.values, sum(part.values for part in parts))
    np.testing.assert_allclose(whole.sd**2, sum(part.sd**2 for part in parts))
    assert whole.unit == "W/kg"


def test_forces_are_forward_and_towards_the_other_foot(side):
    """A walker brakes first and pushes off then; each foot is pushed towards the other one."""
    forward = side.curves[Key("reaction", "forward")].values.mean(axis=0)
    medial = side.curves[Key("reaction", "medial")].values.mean(axis=0)
    assert forward[5:20].mean() < 0.0 < forward[40:55].mean()
    assert medial[10:50].mean() > 0.0


def test_the_midline_is_mirrored_on_the_left():
    mirrored = mirrored_midline(reference_body(trial().subject))
    assert {"pelvis_list", "pelvis_rotation", "lumbar_bending", "lumbar_rotation", "pelvis_tz"} <= mirrored
    assert not {"pelvis_tilt", "lumbar_extension", "pelvis_tx", "pelvis_ty"} & mirrored
    assert not any(name.endswith(("_r", "_l")) for name in mirrored)
    left = cycles_of_trial(trial(), gait(), 1)
    cycle = left.cycles[0].cycle
    for name, sign in (("pelvis_list", -1.0), ("pelvis_tilt", 1.0)):
        own = sign * np.rad2deg(over_cycle(trial().times_s, trial().angle(name), cycle))
        np.testing.assert_allclose(left.curves[Key("angle", name)].values[0], own)


def test_a_mirrored_walk_shows_the_same_on_either_side():
    """Both sides of the made walk do alike, half a cycle apart: pelvis curves of right and left agree in shape."""
    right, left = (
        cycles_of_trial(trial(), gait(), k).curves[Key("angle", "pelvis_list")].values.mean(axis=0)
        for k in (0, 1)
    )
    assert np.corrcoef(right, left)[0, 1] > 0.9


def test_cycles_in_which_the_body_is_lost_are_left_out():
    cycle = gait().of(0)[0]
    tracked = trial().tracked & ~(
        (trial().times_s > cycle.start_s + 0.2) & (trial().times_s < cycle.start_s + 0.3)
    )
    kept = cycles_of_trial(replace(trial(), tracked=tracked), gait(), 0)
    assert cycle not in [one.cycle for one in kept.cycles]
    assert len(kept.cycles) == len(gait().of(0)) - 1
    assert cycles_of_trial(trial(), None, 0).cycles == ()


def test_measured_cycles_are_told_from_estimated_ones():
    cycle = gait().of(0)[0]
    some = estimated(trial(), np.flatnonzero(trial().times_s > cycle.end_s + 1e-9))
    first, *others = cycles_of_trial(some, gait(), 0).cycles
    assert first.measured and not any(one.measured for one in others) and all(one.valid for one in others)


def test_a_frame_or_two_at_a_cycles_ends_do_not_matter():
    cycle = gait().of(0)[0]
    near = trial().times_s - cycle.start_s
    for late_s, measured in ((0.02 * cycle.seconds, True), (0.06 * cycle.seconds, False)):
        some = estimated(trial(), np.flatnonzero((near >= 0.0) & (near < late_s)))
        assert cycles_of_trial(some, gait(), 0).cycles[0].measured == measured


def test_trials_are_put_together_by_what_all_know():
    one, two = (cycles_of_trial(r, find_gait(r), 0) for r in walks())
    both = together([one, two], 0)
    assert len(both.cycles) == len(one.cycles) + len(two.cycles)
    key = Key("angle", "hip_flexion")
    np.testing.assert_array_equal(
        both.curves[key].values, np.vstack([one.curves[key].values, two.curves[key].values])
    )
    less = type(two)(0, two.cycles, {k: v for k, v in two.curves.items() if k != key})
    assert key not in together([one, less], 0).curves
    assert together([type(one)(0, (), {})], 0).cycles == ()


@pytest.mark.parametrize(
    ("key", "side", "part"),
    [
        (Key("angle", "knee_angle"), 0, "right_leg"),
        (Key("torque", "knee_angle"), 1, "left_leg_loads"),
        (Key("power", "hip_flexion"), 0, "right_leg_loads"),
        (Key("reaction", "upward"), 1, "left_leg_loads"),
        (Key("angle", "pelvis_tilt"), 1, "pelvis"),
        (Key("angle", "lumbar_extension"), 0, "trunk"),
        (Key("torque", "lumbar_extension"), 0, "trunk_loads"),
        (Key("torque", "elbow_flex"), 1, "left_arm"),
    ],
)
def test_each_curve_belongs_to_a_part_of_the_verdict(key, side, part):
    assert part_of_curve(reference_body(trial().subject), key, side) == part


def test_curves_that_may_not_be_used_are_nan():
    plate = Reason("left_leg_loads", "do not use", "plate turned", "wrong", "mend it")
    left = cycles_of_trial(replace(trial(), verdict=Verdict.of([plate])), gait(), 1)
    right = cycles_of_trial(replace(trial(), verdict=Verdict.of([plate])), gait(), 0)
    assert np.isnan(left.curves[Key("torque", "knee_angle")].values).all()
    assert np.isfinite(left.curves[Key("angle", "knee_angle")].values).all()
    assert np.isfinite(right.curves[Key("torque", "knee_angle")].values).all()


def test_a_foot_beside_the_plates_is_not_measured():
    """Without a plate below it a foot has no force in stance: that is no measurement of zero."""
    source = trial().foot_source.copy()
    source[:, 1] = Source.NONE
    beside = replace(trial(), foot_source=source, valid=np.zeros_like(trial().valid))
    right, left = (cycles_of_trial(beside, gait(), k).cycles for k in range(2))
    assert right and all(one.measured for one in right)
    assert left and not any(one.measured or one.valid for one in left)
