"""The dynamic filter on trials: its start, the spread of its torques, and what smoothing keeps of Newton's law."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.filters.dynamic.plant import DynamicState
from mbkf.filters.dynamic.report import ROUNDS, DynamicReport
from mbkf.filters.dynamic.settings import DynamicSettings
from mbkf.model.trunk_sections import TrunkSections
from mbkf.sensors.contact.records import Contact, FreeStance
from mbkf.sensors.contact.sharing import Stance, push_apart
from tests.dynamics import settings_with
from tests.followed import FRAMES, SETTLED, estimates, made, made_filter, recording, torques, tracked
from tests.motions import assert_near, worst

RIGHT, LEFT = 0, 1


def truth(name):
    return getattr(made().motion, name)[FRAMES.start : FRAMES.stop]


def breaches_n(balance, found):
    """(T,) force by which estimates break Newton's law with the residual that they state."""
    states = [one.record.state for one in found]
    broken = [balance.root(s.q, s.v, s.a, s.w).residual + s.extra for s in states]
    return np.linalg.norm(np.array(broken)[:, :3], axis=1)


@pytest.mark.slow
def test_a_start_agrees_with_the_plates():
    tracking, found = estimates("dynamic")
    first = found[0]
    off = first.wrench - recording().plates[0]
    assert worst(off[:, :3]) < 15.0
    assert first.contact == (Contact.MEASURED, Contact.MEASURED)
    root = tracking.kalman.balance.root(first.q, first.v, first.a, first.wrench.ravel())
    assert worst(root.residual) < 5.0


@pytest.mark.usefixtures("either_kernel")
def test_torques_and_the_trunks_moments_come_with_the_spread_of_the_whole_state():
    """T P Tᵀ with T their derivative, here by finite differences along the state."""
    tracking, found = made_filter("dynamic"), estimates("dynamic")[1]
    state: DynamicState = found[5].record.state
    model, nv = made().model, made().model.nv
    balance, sections = tracking.kalman.balance, TrunkSections(model)
    carried = np.zeros((len(sections.levels), 6))

    def loads(x):
        q = model.integrate(state.q, x[:nv])
        v, a, w, _ = np.split(x[nv:], [nv, 2 * nv, 2 * nv + 12])
        motion = q, state.v + v, state.a + a
        tau = balance.tau(*motion, state.w + w)
        return np.r_[tau, sections.moments(*motion, carried, tau[:6]).ravel()]

    h = 1e-6
    T = np.array([(loads(h * e) - loads(-h * e)) / (2 * h) for e in np.eye(len(state.P))]).T
    expected = np.einsum("ij,jk,ik->i", T, tracking.report.errors(found[5]).covariance(), T)
    np.testing.assert_allclose(tracking.spread(found[5]).torque ** 2, expected[:nv], rtol=2e-5)
    np.testing.assert_allclose(
        tracking.spread(found[5], levels=True).level_variance.ravel(), expected[nv:], rtol=2e-5
    )
    again = tracking.report.spread(found[5])  # read off the rows with levels
    np.testing.assert_allclose(again.torque**2, expected[:nv], rtol=2e-5)


def test_wrenches_and_motion_come_with_the_states_spread():
    tracking, found = estimates("dynamic")
    nv, stated = made().model.nv, tracking.report.errors(found[5]).covariance()
    own = tracking.kalman.layout.wrench
    np.testing.assert_allclose(tracking.wrench_sd(found[5]).ravel() ** 2, np.diag(stated)[own], rtol=1e-12)
    np.testing.assert_array_equal(tracking.covariance(found[5]), stated[: 2 * nv, : 2 * nv])


def test_dofs_that_markers_observe_are_those_of_the_frame():
    """A limb out of sight between two frames that show it."""
    report, shown = made_filter("dynamic").report, estimates("dynamic")[1][5]
    step, hidden = shown.record.step, np.array([40, 41])
    decisions = step.decisions._replace(notes=replace(step.decisions.notes, unmarked=hidden))
    unseen = shown._replace(record=shown.record._replace(step=step._replace(decisions=decisions)))
    before, between, after = (report.errors(one).seen for one in (shown, unseen, shown))
    assert np.isin(hidden, before).all()
    np.testing.assert_array_equal(between, np.setdiff1d(before, hidden))
    np.testing.assert_array_equal(after, before)


def test_where_only_white_noise_is_expected_the_spread_is_the_filters():
    tracking = made_filter("dynamic")
    tracking.kalman.settings = settings_with(innovation_share=0.0)
    estimate = estimates("dynamic")[1][5]
    np.testing.assert_array_equal(tracking.report.errors(estimate).covariance(), estimate.record.state.P)


def test_reactions_and_torques_follow_the_truth():
    found = tracked("dynamic")
    wrench = found.wrench[SETTLED] - truth("foot_wrench")[SETTLED]
    assert np.sqrt(np.mean(wrench[:, :, :3] ** 2)) < 3.0
    assert 0.8 < np.sqrt(np.mean((wrench / found.wrench_sd[SETTLED]) ** 2)) < 1.3
    off = (torques(found) - truth("tau"))[SETTLED, 6:]
    assert 0.5 < np.sqrt(np.mean((off / found.torque_sd[SETTLED, 6:]) ** 2)) < 1.3


def test_smoothing_keeps_newtons_law():
    """The second linearisation restores what the first one breaks."""
    assert ROUNDS == 2
    tracking, found = estimates("dynamic")
    balance = tracking.kalman.balance
    filtered, smoothed = (breaches_n(balance, run) for run in (found, tracking.smooth(found, len(found))))
    assert np.median(smoothed) < 1.0
    assert np.median(smoothed) < np.median(filtered)


def test_smoothing_moves_wrenches_and_shrinks_their_spread_where_a_plate_is_withheld():
    tracking = made_filter("dynamic", plates=made().plates[:1])
    read = replace(recording(), plates=recording().plates[:, :1])
    found = [tracking.start(read, 0, None)]
    for t in range(1, 40):
        found.append(tracking.step(found[-1], read, t))
    smoothed = tracking.smooth(found, 30)
    middle = slice(15, 30)
    before, after = (
        np.array([tracking.wrench_sd(one)[LEFT, 2] for one in run[middle]]) for run in (found, smoothed)
    )
    assert (after < before).all()
    true = truth("foot_wrench")[:40, LEFT, 2]
    error = [
        np.sqrt(np.mean([(one.wrench[LEFT, 2] - true[t]) ** 2 for t, one in enumerate(run)][middle]))
        for run in (found, smoothed)
    ]
    assert error[1] < error[0]
    assert found[20].contact == (Contact.MEASURED, Contact.UNMEASURED)


@pytest.mark.parametrize("t", [0, 30])
def test_smoothing_keeps_decisions(t):
    """What was refused and what the feet stood on is the filter's word."""
    tracking, found = estimates("dynamic")
    smoothed = tracking.smooth(found, len(found))
    assert smoothed[t].contact == found[t].contact
    np.testing.assert_array_equal(smoothed[t].refused, found[t].refused)
    assert smoothed[t].started == found[t].started


@pytest.mark.slow
def test_markers_on_skin_with_a_memory_leave_the_spreads_their_places():
    """Such markers read velocities, too, so that their information is that of more than a posture."""
    one = made_filter("dynamic", dynamic=settings_with(skin_memory_s=0.3))
    found = [one.start(recording(), 0, None)]
    for t in range(1, 6):
        found.append(one.step(found[-1], recording(), t))
    P, nv = found[-1].record.state.P, made().model.nv
    np.testing.assert_allclose(one.covariance(found[-1]), P[: 2 * nv, : 2 * nv], rtol=1e-12)
    spread = one.spread(found[-1])
    assert np.isfinite(spread.torque[6:]).all()
    assert (spread.torque[6:] > 0).all()
    smoothed = one.smooth(found, len(found))
    assert worst(smoothed[0].q - found[0].q) < 0.2


def test_quiet_plates_narrow_the_wrenches_that_they_read_not_how_two_feet_share_one():
    tracking, found = estimates("dynamic")
    record = found[30].record
    noise = record.detail.plate_noise
    noise = noise._replace(force=noise.force._replace(sd=0.3), moment=noise.moment._replace(sd=0.5))
    quiet = found[30]._replace(record=record._replace(detail=record.detail._replace(plate_noise=noise)))
    notes = record.step.decisions.notes
    contact = notes.contact
    assert contact.contacts == (Contact.MEASURED, Contact.MEASURED)
    sd = tracking.wrench_sd(quiet)
    notes = replace(notes, contact=replace(contact, contacts=(Contact.SHARED,) * 2))
    step = record.step._replace(decisions=record.step.decisions._replace(notes=notes))
    shared = tracking.wrench_sd(quiet._replace(record=quiet.record._replace(step=step)))
    own = np.sqrt(np.diag(quiet.record.state.P)[tracking.kalman.layout.wrench]).reshape(2, 6)
    assert (shared >= own).all()
    assert (sd[:, 2] < 0.5 * own[:, 2]).all()
    moments = noise._replace(moment=noise.moment._replace(sd=0.01))
    still = found[30]._replace(record=record._replace(detail=record.detail._replace(plate_noise=moments)))
    quieter = tracking.wrench_sd(still)
    assert (quieter[:, 3] < 0.8 * sd[:, 3]).all()
    np.testing.assert_allclose(quieter[:, :3], sd[:, :3])


def test_white_noise_of_a_plate_is_not_counted_again_as_a_change_within_the_frame():
    """Second differences of √6 σ are noise; beyond that they count as far as they exceed it."""
    tracking, found = estimates("dynamic")
    record, share = found[30].record, DynamicSettings().errors.frame_share[1]
    detail = record.detail
    noise = detail.plate_noise._replace(
        force=detail.plate_noise.force._replace(sd=1.0),
        moment=detail.plate_noise.moment._replace(sd=0.2),
    )

    def force_sd(bend_n):
        change = np.zeros((2, 2, 6))
        change[1, :, 2] = bend_n
        other = detail._replace(plate_noise=noise, wrench=change)
        return tracking.wrench_sd(found[30]._replace(record=record._replace(detail=other)))[0, 2]

    still = force_sd(0.0)
    assert force_sd(2.4) == still
    assert force_sd(25.0) ** 2 - still**2 == pytest.approx(share**2 * (25.0**2 - 6.0))


def test_a_smoothed_estimate_may_bend_wrongly_where_it_bends():
    """The second differences of accelerations and wrenches, of the neighbours at both ends."""
    tracking, found = estimates("dynamic")
    smoothed = tracking.smooth(found[:8], 8)
    stated = np.array([np.concatenate([one.record.state.a, one.record.state.w]) for one in smoothed])
    bend = np.diff(stated, n=2, axis=0)[[0, *range(6), 5]]
    share = (DynamicSettings().errors.corner_s / tracking.kalman.plant.dt_s) ** 2
    late = np.array([one.record.detail.late for one in smoothed])
    np.testing.assert_allclose(late[:, 1, : bend.shape[1]], share * bend)
    np.testing.assert_allclose(
        np.abs(late[0, 0, : bend.shape[1]]),
        DynamicSettings().errors.lag_s / tracking.kalman.plant.dt_s * np.abs(stated[1] - stated[0]),
    )
    (alone,) = tracking.smooth(found[:8], 1)
    assert len(alone.record.detail.late) == 1, "one state has no second difference"


def on_free_floor(estimate, ahead_m):
    """The estimate with both feet on unread floor, the right one ahead; and the push of forces to the pelvis."""
    record = estimate.record
    notes = record.step.decisions.notes
    centres = np.array([[ahead_m, -0.15, 0.0], [0.0, 0.15, 0.0]])
    stance, pelvis = Stance(centres, np.zeros((2, 3)), np.array([1.0, 0.0])), np.array([0.1, 0.0, 0.9])
    free = FreeStance(stance, pelvis)
    kinds = (Contact.UNMEASURED,) * 2
    notes = replace(notes, contact=replace(notes.contact, contacts=kinds, centres_m=centres, free=free))
    step = record.step._replace(decisions=record.step.decisions._replace(notes=notes))
    found = estimate._replace(record=record._replace(step=step))
    return found, push_apart(stance, pelvis, estimate.wrench[:, 2])


@pytest.mark.parametrize(("ahead_m", "place"), [(0.0, 0), (0.5, 1)])
def test_how_two_feet_without_a_plate_push_apart_is_open(ahead_m, place):
    """Their forces err by a share of the push, opposed, and the torques of the legs with them; the sum does not."""
    tracking, found = estimates("dynamic")
    free, push = on_free_floor(found[30], ahead_m)
    share = tracking.kalman.settings.errors.push_share[place]
    added = DynamicReport(tracking.kalman).errors(free).added[:, tracking.kalman.layout.wrench]
    assert_near(added[4], share * push.ravel(), 1e-9)
    assert_near(added[4].reshape(2, 6).sum(axis=0), np.zeros(6), 1e-9)
    assert (tracking.wrench_sd(free)[:, :2] >= np.abs(share * push[:, :2])).all()
    assert not DynamicReport(tracking.kalman).errors(found[30]).added[4].any()


def test_a_hardly_loaded_foot_without_a_plate_may_bear_a_share_of_body_weight():
    tracking, found = estimates("dynamic")
    free, _ = on_free_floor(found[30], 0.0)
    report = DynamicReport(tracking.kalman)
    weight_n = GRAVITY_M_S2 * tracking.kalman.model.mass_kg
    most = tracking.kalman.settings.errors.edge_share * weight_n
    loaded, light = (
        report.errors(one).added[RIGHT, tracking.kalman.layout.wrench][2]
        for one in (free, free._replace(wrench=np.zeros((2, 6))))
    )
    assert light == pytest.approx(most)
    assert loaded < 0.1 * most
