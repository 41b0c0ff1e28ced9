"""The thesis's filter on trials: its start, its torques and wrenches, feet without a plate, and its smoother."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.sensors.contact.records import Contact
from tests.followed import (
    FRAMES,
    SETTLED,
    WHOLE,
    estimates,
    inputs,
    made,
    made_filter,
    recording,
    torques,
    tracked,
)
from tests.motions import worst

LEFT = 1


def truth(name):
    return getattr(made().motion, name)[FRAMES.start : FRAMES.stop]


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def test_a_start_agrees_with_the_plates_and_newton():
    _, found = estimates("torque")
    first = found[0].record.detail
    assert worst(first.foot_wrench[:, :3] - recording().plates[0][:, :3]) < 10.0
    assert worst(first.tau[:3]) < 15.0
    assert found[0].contact == (Contact.MEASURED, Contact.MEASURED)


def test_torques_are_states_with_their_spread():
    tracking, found = estimates("torque")
    for one in (found[0], found[5]):
        np.testing.assert_array_equal(tracking.spread(one).torque, one.record.detail.tau_sd)
        np.testing.assert_array_equal(tracking.wrench_sd(one), one.record.detail.foot_wrench_sd)
        np.testing.assert_array_equal(one.wrench, one.record.detail.foot_wrench)


def test_reactions_and_torques_follow_the_truth():
    found = tracked("torque")
    known = np.isfinite(found.torque_sd[1])
    off = (torques(found) - truth("tau"))[SETTLED][:, known]
    assert worst(off[:, 6:] / found.torque_sd[SETTLED][:, known][:, 6:]) < 4.0
    assert rms((found.wrench - truth("foot_wrench"))[SETTLED, :, :3]) < 3.0


def test_its_torques_are_inverse_dynamics_of_its_own_motion():
    """a, w and τ of a state obey Newton's law together; toes and head are kinematic."""
    _, found = estimates("torque")
    again = torques(tracked("torque"))
    known = np.isfinite(tracked("torque").torque_sd[1])
    for t in (1, 20, 50):
        np.testing.assert_allclose(again[t][known], found[t].record.detail.tau[known], rtol=0, atol=1e-5)


def test_smoothed_estimates_obey_newton_too():
    found = tracked("torque", WHOLE)
    tracking, before = estimates("torque")
    smoothed = tracking.smooth(before, len(before))
    known = np.isfinite(found.torque_sd[1])
    for t in (0, 20, 59):
        assert np.abs(torques(found)[t][known] - smoothed[t].record.detail.tau[known]).max() < 1e-5


def test_a_foot_without_a_plate_is_inferred():
    tracking = made_filter("torque", plates=made().plates[:1])
    read = replace(recording(), plates=recording().plates[:, :1])
    found = [tracking.start(read, 0, None)]
    for t in range(1, 40):
        found.append(tracking.step(found[-1], read, t))
    assert found[20].contact == (Contact.MEASURED, Contact.UNMEASURED)
    vertical = np.array([one.wrench[LEFT, 2] for one in found]) - truth("foot_wrench")[:40, LEFT, 2]
    sd = np.array([tracking.wrench_sd(one)[LEFT, 2] for one in found])
    assert rms(vertical[20:]) < 80.0
    assert (sd[20:] > 10.0).all()
    assert tracking.innovations(found[20]).readings.sum() == 3 * 36 + 6


def test_a_loss_of_markers_leaves_the_plates():
    tracking, found = estimates("torque")
    blind = replace(recording(), markers_m=np.full_like(recording().markers_m, np.nan))
    step = tracking.step(found[20], blind, 21)
    assert not step.tracked
    assert tracking.innovations(step).readings.sum() == 12
    assert step.contact == found[21].contact


def test_what_cannot_be_computed_is_untracked():
    """The state stays, contact is still decided, and a smoother passes over the frame."""
    tracking, found = estimates("torque")
    record = found[20].record
    broken = found[20]._replace(
        record=record._replace(state=replace(record.state, P=-1e3 * np.eye(len(record.state.P))))
    )
    step = tracking.step(broken, recording(), 21)
    assert not step.tracked and not step.started
    assert step.q is broken.record.detail.q
    assert step.contact == found[21].contact
    assert not step.refused.any()
    assert tracking.innovations(step) is None
    passed = step._replace(record=step.record._replace(state=record.state))
    smoothed = tracking.smooth([found[20], passed], 2)
    np.testing.assert_allclose(smoothed[0].q, found[20].q, rtol=0, atol=1e-12)


@pytest.mark.parametrize("keep", [1, 5])
def test_smoothing_a_few_frames(keep):
    tracking, found = estimates("torque")
    smoothed = tracking.smooth(found[:keep], keep)
    np.testing.assert_allclose(smoothed[-1].q, found[keep - 1].q, rtol=0, atol=1e-12)
    assert len(smoothed) == keep


def test_it_starts_as_the_kinematic_filter_does():
    kinematic = made_filter("kinematic", kinematic=inputs().kinematic).start(recording(), 0, None)
    _, found = estimates("torque")
    moved = made().model.difference(kinematic.q, found[0].q)
    assert worst(moved / tracked("torque").sd_q[0]) < 1.0
