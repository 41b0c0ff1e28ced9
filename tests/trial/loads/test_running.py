"""Unexplained loads as frames come: the trial's windows, each ending now; soon stated, and gone when the load is."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.trial.loads.balance import BRIDGE_S
from mbkf.trial.loads.flags import LIMITS
from mbkf.trial.loads.running import HELD_S, RunningBalance, stated_frames
from tests.bodies_in_balance import RATE_HZ, UP, WEIGHT_N, lagging, moving, times_of, unloaded
from tests.motions import assert_near


def followed(balance):
    """Judgements of all frames."""
    running = RunningBalance(balance.mass_kg, balance.rate_hz)
    contacts = balance.feet_n.sum(axis=1) + balance.others_n
    return [running.push(*one) for one in zip(balance.centre_m, contacts, balance.judged, strict=True)]


def acts_in(balance):
    return np.array([one.acts for one in followed(balance)])


def test_forces_are_those_of_the_trials_windows():
    """Over more frames than are kept at once."""
    balance = unloaded(moving(8.0), 0.3 * WEIGHT_N * UP, 2.0, 4.0)
    means = balance.means(0.5)
    found = np.array([one.force_n for one in followed(balance)])
    assert np.isnan(found[: means.frames - 1]).all()
    assert_near(found[means.frames - 1 :], means.missing(balance.mass_kg), 1e-6)


def test_a_body_on_its_feet_is_never_accused():
    assert not acts_in(moving(8.0)).any()


@pytest.mark.parametrize("share", [0.1, -0.1, 0.3, 1.0])
def test_a_load_is_stated_within_half_a_second_and_gone_soon_after(share):
    balance = unloaded(moving(8.0), share * WEIGHT_N * UP, 2.0, 5.0)
    acts, t = acts_in(balance), times_of(balance)
    assert not acts[t < 2.0].any()
    assert acts[(t >= 2.5) & (t <= 5.0)].all()
    assert not acts[t > 5.75].any()


@pytest.mark.parametrize("share", [0.3, -0.3, 0.8])
def test_a_load_at_the_first_frame_is_stated_within_half_a_second(share):
    balance = unloaded(moving(2.0), share * WEIGHT_N * UP)
    assert acts_in(balance)[times_of(balance) >= 0.5].all()


def test_a_large_load_is_stated_within_a_third_of_a_second():
    balance = unloaded(moving(), 0.25 * WEIGHT_N * UP, 2.0)
    acts, t = acts_in(balance), times_of(balance)
    assert acts[t >= 2.33].all() and not acts[t < 2.0].any()


@pytest.mark.parametrize("hz", [2.7, 3.0, 3.5])
def test_positions_that_lag_behind_in_a_run_are_no_load(hz):
    """Half a second holds one and a half steps of them, and so reads more than its limit."""
    late = lagging(moving(8.0, hz, 0.045), 2)
    force = np.array([one.force_n[2] for one in followed(late)])
    assert np.nanmax(np.abs(force)) > LIMITS[-1].share * WEIGHT_N
    assert not acts_in(late).any()
    assert acts_in(unloaded(late, 0.2 * WEIGHT_N * UP, 3.0, 5.0))[360:500].all()


def test_plates_with_another_clock_are_stated_in_a_run():
    late = lagging(moving(8.0, 2.7, 0.05), 10)
    assert acts_in(late)[120:].mean() > 0.9


def test_a_pull_along_the_floor_counts_where_plates_read_it():
    balance = unloaded(moving(), 0.2 * WEIGHT_N * np.array([1.0, 0.0, 0.0]), 2.0, 4.0)
    assert acts_in(balance).any()
    assert not acts_in(replace(balance, feet_n=balance.feet_n * UP)).any()


def test_short_gaps_are_bridged_and_long_ones_begin_anew():
    balance = moving(4.0)
    judged = balance.judged.copy()
    judged[100:110] = judged[250:270] = False
    found = np.array([one.force_n[2] for one in followed(replace(balance, judged=judged))])
    assert np.isfinite(found[60:260]).all()
    assert np.isnan(found[260 : 270 + 60]).all() and np.isfinite(found[330:]).all()


def test_a_stated_load_outlasts_frames_that_no_plate_reads_for_a_while():
    balance = unloaded(moving(8.0), 0.5 * WEIGHT_N * UP, 1.0)
    judged = balance.judged.copy()
    judged[300:600] = False
    acts = acts_in(replace(balance, judged=judged))
    gone = 300 + round(HELD_S * RATE_HZ)
    assert acts[200:gone].all() and not acts[gone + 1 : 600].any()


def test_a_foot_that_comes_down_beside_its_plate_is_no_load():
    """Its load is missing for a moment before it is seen to stand there."""
    balance = unloaded(moving(8.0), 0.9 * WEIGHT_N * UP, 3.0)
    judged = balance.judged.copy()
    for seen, held in ((8, 0), (18, 2 * round(BRIDGE_S * RATE_HZ))):
        judged[300 + seen :] = False
        assert acts_in(replace(balance, judged=judged)).sum() <= held
        judged[:] = True


def test_no_load_is_stated_anew_in_frames_that_are_not_judged():
    balance = unloaded(moving(8.0), 0.9 * WEIGHT_N * UP, 3.0)
    judged = balance.judged.copy()
    judged[302:312] = False
    acts = acts_in(replace(balance, judged=judged))
    assert not acts[:312].any() and acts[312:].all()


def test_frames_without_a_body_are_not_judged():
    balance = moving(2.0)
    centre = balance.centre_m.copy()
    centre[150] = np.nan
    found = followed(replace(balance, centre_m=centre))
    assert np.isfinite(found[149].force_n).all()
    assert all(np.isnan(one.force_n).all() for one in found[150:])


def test_a_cut_begins_anew():
    balance = moving(2.0)
    running = RunningBalance(balance.mass_kg, balance.rate_hz)
    contacts = balance.feet_n.sum(axis=1)
    for t in range(100):
        found = running.push(balance.centre_m[t], contacts[t], True)
    assert np.isfinite(found.force_n).all()
    running.cut()
    assert np.isnan(running.push(balance.centre_m[100], contacts[100], True).force_n).all()


def test_a_trial_is_judged_as_a_live_run_would():
    balance = unloaded(moving(8.0), 0.5 * WEIGHT_N * UP, 1.0)
    assert (stated_frames(balance) == acts_in(balance)).all()


def test_frames_of_a_trial_that_are_not_judged_end_the_windows():
    """Their positions are any numbers."""
    balance = moving(4.0)
    judged, centre = balance.judged.copy(), balance.centre_m.copy()
    judged[200:205] = False
    centre[200:205] = 0.0
    assert not stated_frames(replace(balance, judged=judged, centre_m=centre)).any()
