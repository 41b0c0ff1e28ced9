"""Consistency of a method on a synthetic case: NEES, coverage and NIS against known errors."""

import math
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.dynamic import synthetic_consistency
from benchmarks.dynamic.methods import in_turn
from benchmarks.dynamic.synthetic import FCDI, MATCHED, make_case
from benchmarks.dynamic.synthetic_consistency import CaseConsistency, consistency_of, consistency_rows


@pytest.fixture(scope="module")
def case():
    return make_case(("squat", 0), MATCHED, correct=False)


def test_consistency_of_a_result_with_true_spreads(case, monkeypatch):
    found = FCDI.run(case.capture, case.subject)
    rng = np.random.default_rng(1)
    wrong = tuple(rng.normal(0.0, 0.1, (found.frames, 46)) for _ in range(3))
    spread = np.full_like(found.sd_q, 0.1)
    consistent = replace(found, sd_q=spread, sd_v=2.0 * spread, sd_tau=0.5 * spread)
    monkeypatch.setattr(synthetic_consistency.Method, "run", lambda *_, **__: consistent)
    monkeypatch.setattr(synthetic_consistency, "differences", lambda *_: wrong)
    judged = consistency_of(case, FCDI)
    assert judged.nees == pytest.approx((1.0, 0.25, 4.0), rel=0.05)
    assert judged.coverage == pytest.approx((0.95, 0.99991, 0.673), abs=0.01)
    assert math.isnan(judged.joint_nees)
    assert judged.nis == pytest.approx(np.mean(found.nis[50:] / found.nis_readings[50:]))


def test_consistency_of_the_defaults_is_shown_without_bounds(monkeypatch):
    monkeypatch.setattr(synthetic_consistency, "make_case", lambda key, **_: key)
    made = CaseConsistency((1.0, 1.0, 2.0), (0.95, 0.95, 0.8), 1.0, 3.0)
    monkeypatch.setattr(synthetic_consistency, "consistency_of", lambda case, method: made)
    rows = consistency_rows([("squat", 0)], [FCDI], in_turn)
    assert not any(row.bounded for row in rows)
    assert [row.value for row in rows] == [1.0, 95.0, 1.0, 95.0, 2.0, 80.0, 1.0, 3.0]


def test_joint_consistency_uses_the_whole_covariance(case):
    assert 0.1 < consistency_of(case, FCDI).joint_nees < 10.0
