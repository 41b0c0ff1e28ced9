"""Rows of the benchmark of verdicts: shares of words, wrong results under "use", and reasons of wrong results."""

from pathlib import Path

import pytest

from benchmarks.verdict.recorded import Base
from benchmarks.verdict.rows import faulty_rows, reason_rows, right_rows
from benchmarks.verdict.spoilt import Found, Spoilt
from benchmarks.verdict.trials import Judged
from mbkf.io.verdict import MOTION_PARTS
from mbkf.trial.verdict.evidence import Evidence
from mbkf.trial.verdict.fit import PartFit

NAN = float("nan")
BASE = Base("own", "walk", Path(), "1")


def judged(word):
    return Judged("walk 3", word, NAN, NAN, word)


def found(kind="mass", angle_deg=0.0, per_noise=1.0):
    """Findings on a trial whose right leg errs by an angle, and whose markers fit it so."""
    fit = PartFit("right_leg", 9, 10.0, per_noise, 1.0, 0.0, "RKNE")
    return Found(
        Spoilt(BASE, kind),
        "a fault",
        "",
        Evidence(fits=(fit,)),
        {"right_leg": angle_deg, "left_leg": 0.0},
        {},
    )


def bounded(rows):
    return {one.name: (one.value, one.passed) for one in rows if one.bounded}


def test_right_trials_are_counted_by_word_and_refused_ones_are_left_alone():
    rows = bounded(right_rows("shown on", [judged("use")] * 7 + [judged("look")] * 2 + [judged("refused")]))
    assert rows == {
        "right trials (shown on, 10) under do not use": (10.0, False),
        "right trials (shown on, 10) under look": (20.0, False),
    }


def test_only_wrong_results_under_use_count():
    trials = [
        found(angle_deg=12.0),
        found(angle_deg=2.0),
        found(angle_deg=30.0, per_noise=2.0),
        Found(Spoilt(BASE, "unit"), "", "refused", None, {}, {}),
    ]
    rows = list(faulty_rows("shown on", trials))
    ((name, (share, passed)),) = bounded(rows).items()
    assert name == "wrong results under use of 4 faulty trials (shown on)"
    assert (share, passed) == (25.0, False)
    by_kind = {one.name: one.value for one in rows if "wrong under use" in one.name and not one.bounded}
    assert by_kind == {
        "mass, shown on (3: 2 use, 1 look): wrong under use": 1,
        "unit, shown on (1: 1 refused): wrong under use": 0,
    }


def test_a_reason_has_the_share_of_its_trials_that_are_wrong():
    trials = [found(angle_deg=30.0, per_noise=2.0), found(angle_deg=1.0, per_noise=2.0), found()]
    (row,) = [one for one in reason_rows(trials) if "not posed" in one.name]
    assert row.name.startswith("look: 'the body is not posed as these markers are' (2 faulty trials)")
    assert row.value == pytest.approx(50.0)


def test_a_leg_that_may_not_be_used_is_not_wrong():
    one = found(angle_deg=40.0, per_noise=3.0)
    assert one.wrong and not one.judged.wrong
    assert one.judged.word == "do not use" and "right_leg" in MOTION_PARTS
