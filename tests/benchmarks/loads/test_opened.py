"""Rows of contacts that open on the way: how late, and with which force."""

from pathlib import Path

import pytest

from benchmarks.loads.opened import LATEST_S, Opened, contact_trials, rows_of


def test_rows():
    good = Opened("chair", (0.3, 0.6), 0.95, 0.1, (1.0, 1.0))
    bad = Opened("rail", (LATEST_S + 0.1,), 0.8, 0.1, (0.5, 1.0))
    passed = [check.passed for check in rows_of([good])]
    assert all(passed) and len(passed) == 5
    late, latest, *others = rows_of([good, bad])
    assert not late.passed and late.value == pytest.approx(200.0 / 3.0)
    assert latest.value == LATEST_S + 0.1
    assert [check.passed for check in others if check.name.endswith("off by")] == [True, False]


def test_a_contact_that_never_opens_is_late():
    late, *_ = rows_of([Opened("chair", (float("inf"),), 1.0, 0.0, (1.0, 1.0))])
    assert late.value == 0.0 and not late.passed


def test_trials():
    every = contact_trials(Path(), quick=False)
    assert len({one.label for one in every}) == len(every) == 12
    assert 0 < len(contact_trials(Path(), quick=True)) < 4
