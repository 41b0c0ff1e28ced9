"""The session benchmark's own arithmetic: what counts as held, and that the change is made in the knees."""

import numpy as np

from benchmarks.session import Found, cover
from benchmarks.session.change import BENT_RAD, bent_walk_plan
from mbkf.study.session.cycles import Key
from mbkf.synthesis.walk import walk_plan
from tests.motions import reference_model

KEY = Key("angle", "knee_angle")


def found(change, true=1.0, half=0.5):
    def all_of(value):
        return {KEY: np.full((2, 101), value)}

    return Found(all_of(change), all_of(half), all_of(true), {})


def test_an_interval_holds_the_mean_of_the_true_changes():
    assert cover([found(1.4), found(0.6)], KEY) == 1.0
    assert cover([found(1.4), found(1.6)], KEY) == 0.5
    assert cover([found(1.4, true=2.0), found(1.4, true=0.0)], KEY) == 1.0


def test_the_bent_walk_differs_in_its_knees_alone():
    plans = [plan(reference_model(), 2.0, np.random.default_rng(1)) for plan in (walk_plan, bent_walk_plan)]
    assert plans[1].straightest_rad - plans[0].straightest_rad == BENT_RAD
    assert plans[0].recorded_s == plans[1].recorded_s
