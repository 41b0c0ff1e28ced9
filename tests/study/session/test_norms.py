"""Norms: each person counts once, and the spread is that between persons."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput, MbkfWarning
from mbkf.io.results_folder import write_reconstruction
from mbkf.io.verdict import Reason, Verdict
from mbkf.study.session.cycles import Key
from mbkf.study.session.gather import session_of
from mbkf.study.session.norms import build_norms, norms_of
from mbkf.trial.results.summary import summarise
from tests.study.session.sessions import estimated, session, walks

KNEE = ("walk", "angle", "knee_angle")


def person_mean(one, key):
    return np.mean([side.curves[key].values.mean(axis=0) for side in one.gaits[0].sides], axis=0)


def test_mean_and_spread_between_persons():
    one, two = session(), session(count=1, first=6)
    norms = norms_of([one, two], "ours")
    means = [person_mean(each, Key("angle", "knee_angle")) for each in (one, two)]
    np.testing.assert_allclose(norms.curves[KNEE].mean, np.mean(means, axis=0))
    np.testing.assert_allclose(norms.curves[KNEE].sd, np.std(means, axis=0, ddof=1))
    assert norms.curves[KNEE].persons == 2 and norms.curves[KNEE].unit == "deg" and norms.name == "ours"
    speeds = [
        np.mean(
            np.concatenate(list(next(m for m in s.gaits[0].measures if m.name == "Speed").values.values()))
        )
        for s in (one, two)
    ]
    np.testing.assert_allclose(norms.measures[("walk", "Speed")].mean, [np.mean(speeds)])


def test_estimated_loads_do_not_count():
    plain = session_of([estimated(r) for r in walks()], "x")
    norms = norms_of([plain, replace(plain, name="y")], "z")
    assert KNEE in norms.curves and ("walk", "torque", "knee_angle") not in norms.curves


def test_one_person_has_no_spread():
    with pytest.raises(InvalidInput, match="2 persons or more"):
        norms_of([session()], "x")


def test_folders_of_a_batch_are_persons(tmp_path):
    for person, first in (("P1", 5), ("P2", 6)):
        for r in walks(1, first):
            write_reconstruction(r, summarise(r), tmp_path / person / "walk")
    norms = build_norms([tmp_path], "ours")
    assert norms.curves[KNEE].persons == 2


def test_a_trial_that_may_not_be_used_is_left_out_and_named():
    turned = Verdict.of([Reason("left_leg", "do not use", "turned over", "wrong", "check names")])
    one, two = session_of([replace(walks()[0], verdict=turned)], "Ana"), session(count=1, first=6)
    with pytest.warns(
        MbkfWarning, match="Ana: walk 0 is left out of the norms where it may not be used: left leg"
    ):
        norms = norms_of([one, two], "ours")
    assert norms.curves[KNEE].persons == 2, "the right knee counts"
    right = one.gaits[0].sides[0].curves[Key("angle", "knee_angle")].values.mean(axis=0)
    both = np.mean([right, person_mean(two, Key("angle", "knee_angle"))], axis=0)
    np.testing.assert_allclose(norms.curves[KNEE].mean, both)
