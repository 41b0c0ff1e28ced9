"""Rows of the campaign: what counts as a divergence, what the bounds are, which trials are named."""

import json

import numpy as np
import pytest

from benchmarks.campaign import told, write
from benchmarks.campaign.draw import drawn
from benchmarks.campaign.rows import WORST, diverged, rows
from benchmarks.campaign.trials import Error, Outcome
from benchmarks.intervals.trials import Judged, Key

NAMES = ("knee", "toe")


def error(deg=(2.0, 3.0), doubt=(1.0, 1.0), smoothed=False, nees=1.0, tracked=1.0, motion="walk"):
    key = Key(motion, 0, 0.003, "static")
    cover = np.array([0.95, 0.95])
    judged = Judged(key, smoothed, (nees,) * 4, cover, cover, NAMES, 2.0)
    return Error(smoothed, np.array(deg), np.array(doubt), NAMES, np.array([3.0, np.nan]), tracked, judged)


def one(seed=0, refused="", failed="", **changes):
    both = () if refused or failed else (error(**changes), error(**changes, smoothed=True))
    return Outcome(drawn(seed), both, refused, failed, 2.0)


@pytest.mark.parametrize(
    ("deg", "doubt", "is_divergence"),
    [
        ((9.9, 3.0), (8.0, 1.0), False),
        ((10.1, 3.0), (3.1, 1.0), True),
        ((10.1, 40.0), (2.9, 2.9), False),
        ((2.0, 46.0), (1.0, 0.5), True),
        ((np.inf, 3.0), (1.0, 1.0), True),
        ((2.0, 12.0), (1.0, np.nan), True),
    ],
)
def test_a_divergence_is_far_and_not_told_or_no_number(deg, doubt, is_divergence):
    assert diverged(error(deg, doubt)) is is_divergence


def value(found, name):
    return next(row for row in found if row.name == name)


def test_good_trials_pass_and_each_fault_fails_its_row():
    assert all(row.passed for row in rows([one(k) for k in range(3)]))
    for spoilt, name in (
        (one(9, deg=(50.0, 1.0)), "causal, divergences"),
        (one(9, failed="ValueError: x"), "ended in an error or a warning of another kind"),
        (one(9, tracked=0.5), "smoothed, least share tracked"),
    ):
        found = rows([one(1), spoilt])
        assert [row.name for row in found if not row.passed and name.split(",")[-1] in row.name]
        assert not value(found, name).passed
    found = rows([one(1), one(2, nees=3.0)])
    assert not value(found, "causal, NEES of q, mean, at most").passed
    assert value(rows([one(1), one(2, refused="NotConverged: x")]), "refused by name").value == 1.0


def test_the_worst_are_named_by_their_seeds():
    outcomes = [one(seed, deg=(float(seed), 1.0), doubt=(9.0, 1.0)) for seed in range(20)]
    named = [row.name for row in rows(outcomes) if row.name.startswith("seed ")]
    assert [int(name.split(":")[0].split()[1]) for name in named] == list(range(19, 19 - WORST, -1))
    assert rows([one(4, failed="ValueError: x")])[-1].name == "seed 4: ValueError: x"


def test_every_trial_has_its_line_in_the_file_the_worst_first(tmp_path):
    outcomes = [one(0), one(1, deg=(30.0, 1.0), doubt=(5.0, 1.0)), one(2, failed="ValueError: x")]
    write(outcomes, tmp_path / "trials.json")
    lines = json.loads((tmp_path / "trials.json").read_text())
    assert sorted(line["seed"] for line in lines) == [0, 1, 2]
    assert [line["seed"] for line in lines if "causal" in line] == [1, 0]
    assert told(outcomes[1])["causal"]["deg"] == 30.0
    assert told(outcomes[2])["failed"] == "ValueError: x"
