"""Spreads by phase: which feet count in which, and bounds that tell too small from too large."""

from types import SimpleNamespace

import numpy as np

from benchmarks.contact.running import COVER, SPREAD, _spread_rows, phases


def pair(contact, vertical, off, sd):
    """Truth and found of frames (T, 2)."""
    contact, vertical = np.array(contact), np.array(vertical, dtype=float)
    wrench, wrong = np.zeros((len(contact), 2, 6)), np.zeros((len(contact), 2, 6))
    wrench[:, :, 2], wrong[:, :, 2] = vertical, vertical + off
    every = np.ones(len(contact), dtype=bool)
    times = np.arange(len(contact)) / 100.0
    truth = SimpleNamespace(foot_contact=contact, foot_wrench=wrench, measured=every, times_s=times)
    return truth, SimpleNamespace(foot_wrench=wrong, foot_wrench_sd=np.full(wrench.shape, sd), tracked=every)


def test_phases_are_told_by_what_truly_bears():
    contact = [[1, 0], [1, 1], [0, 0], [-1, 1]]
    vertical = [[700, 0], [300, 400], [0, 0], [0, 700]]
    truth, found = pair(contact, vertical, 10.0, 5.0)
    apart = phases(truth, found, False)
    assert {phase: len(values) for phase, values in apart.items()} == {
        "single support": 1,
        "double support": 2,
    }
    running = phases(truth, found, True)
    assert list(running) == ["run"] and len(running["run"]) == 3
    np.testing.assert_allclose(running["run"], 2.0)


def test_spreads_that_are_right_pass_and_others_fail():
    z = np.random.default_rng(0).normal(size=4000)
    for factor, passes in ((1.0, True), (0.3, False), (2.0, False)):
        rows = [row for row in _spread_rows("x", {"a": factor * z, "b": factor * z}) if row.bounded]
        assert all(row.passed for row in rows) == passes
    assert SPREAD[0] < 1.0 < SPREAD[1] and COVER[0] < 95.0 < COVER[1]
