"""Unexplained loads of a trial: size, direction, time, and the frames that they spoil."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.trial.loads.unexplained import unexplained_loads
from tests.bodies_in_balance import UP, WEIGHT_N, lagging, moving, times_of, unloaded
from tests.motions import assert_near


def found_in(balance):
    return unexplained_loads(balance, times_of(balance))


def test_a_body_on_its_feet_has_none():
    found = found_in(moving())
    assert found.loads == () and not found.acts.any()
    assert_near(found.force_n, 0.0, 1e-3 * WEIGHT_N)


def test_a_seat_bears_upward_from_when_to_when():
    found = found_in(unloaded(moving(6.0), 0.8 * WEIGHT_N * UP, 1.5, 4.0))
    (seat,) = found.loads
    assert seat.from_s == pytest.approx(1.5, abs=0.12) and seat.to_s == pytest.approx(4.0, abs=0.12)
    assert seat.direction == "upward" and seat.cause == ""
    assert seat.force_n == pytest.approx(0.8 * WEIGHT_N, rel=0.06)
    assert seat.share == pytest.approx(seat.force_n / WEIGHT_N)
    assert 0.009 * WEIGHT_N < seat.sd_n < 0.02 * WEIGHT_N
    assert_near(found.force_n[275], 0.8 * WEIGHT_N * UP, 0.01 * WEIGHT_N)


@pytest.mark.parametrize("share", [0.12, 0.3, 1.0])
def test_no_frame_under_a_load_counts(share):
    """A load that comes and goes slowly spoils every frame in which it exceeds 8 % of body weight."""
    balance = moving(6.0)
    t = times_of(balance)
    ramp = np.clip(np.minimum(t - 1.0, 5.0 - t) / 0.8, 0.0, 1.0)[:, None]
    load = share * WEIGHT_N * UP * ramp
    found = found_in(replace(balance, feet_n=balance.feet_n - 0.5 * load[:, None]))
    assert found.acts[load[:, 2] > 0.08 * WEIGHT_N].all()
    assert not found.acts[(t < 0.7) | (t > 5.3)].any()


def test_loads_of_both_directions_stand_in_order():
    balance = unloaded(moving(6.0), 0.3 * WEIGHT_N * UP, 3.8, 5.0)
    found = found_in(unloaded(balance, -0.2 * WEIGHT_N * UP, 1.0, 2.2))
    assert [one.direction for one in found.loads] == ["downward", "upward"]


def test_a_pull_along_the_floor_is_horizontal():
    (pull,) = found_in(unloaded(moving(6.0), 0.2 * WEIGHT_N * np.array([0.0, -1.0, 0.0]), 2.0, 4.0)).loads
    assert pull.direction == "horizontal"
    assert pull.vector_n[1] == pytest.approx(-0.2 * WEIGHT_N, rel=0.08)


def test_frames_whose_contacts_are_not_read_say_nothing():
    balance = unloaded(moving(), 0.8 * WEIGHT_N * UP, 1.5, 4.0)
    found = found_in(replace(balance, judged=np.zeros_like(balance.judged)))
    assert found.loads == () and not found.acts.any() and np.isnan(found.force_n).all()


def test_causal_positions_that_lag_behind_in_a_run_are_no_load():
    run = lagging(moving(8.0, 3.0, 0.045), 2)
    assert found_in(run).acts.any()
    found = unexplained_loads(run, times_of(run), causal=True)
    assert found.loads == () and not found.acts.any()
    assert_near(found.force_n, found_in(run).force_n, 0.0)


def test_causal_results_keep_the_load_that_a_live_run_states():
    seated = unloaded(moving(6.0), 0.8 * WEIGHT_N * UP, 1.5, 4.0)
    found, causal = found_in(seated), unexplained_loads(seated, times_of(seated), causal=True)
    assert causal.loads == found.loads and (causal.acts == found.acts).all()
