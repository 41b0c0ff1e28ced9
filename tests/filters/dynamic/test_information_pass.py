"""The pass that keeps information is the one that keeps covariances, and leaves to it what it cannot take."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.filters.dynamic import smoother
from mbkf.filters.dynamic.information_pass import NoiseMemory, information_pass
from mbkf.filters.dynamic.smoother import smooth
from mbkf.kernel.loading import library
from tests.dynamics import follow, trial
from tests.motions import worst

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def run():
    if library() is None:
        pytest.skip("the kernel is not compiled here")
    return follow(trial("squat"), range(40, 75))


def passed(run, states=None):
    states = run.states if states is None else states
    decided = [step.decisions for step in run.steps]
    return information_pass(run.kalman, states[0], states, decided, 20, NoiseMemory())


def test_a_window_is_the_one_by_covariances(run, monkeypatch):
    """Means, covariances, and what the next window goes on from; two rounds and three."""
    found = passed(run)
    assert found is not None
    for rounds in (2, 3):
        memory = smoother.WindowMemory(), smoother.WindowMemory()
        by_information = list(smooth(run.kalman, run.steps, rounds, 25, memory[0]))
        with monkeypatch.context() as patch:
            patch.setattr(smoother, "information_pass", lambda *_: None)
            by_covariances = list(smooth(run.kalman, run.steps, rounds, 25, memory[1]))
        kept = [one.start(run.steps[24].state) for one in memory]
        assert kept[0] is not run.steps[24].state
        for one, other in zip([*by_information, kept[0]], [*by_covariances, kept[1]], strict=True):
            sd = np.sqrt(np.diag(other.P))
            assert worst(run.kalman.plant.difference(other, one) / sd) < 1e-5
            assert worst((one.P - other.P) / np.outer(sd, sd)) < 1e-5


def test_what_it_cannot_take_is_left(run, monkeypatch):
    """Components that are certain, noise of several numbers per dof, and no kernel."""
    P = run.states[0].P.copy()
    P[5], P[:, 5] = 0.0, 0.0
    assert passed(run, [replace(run.states[0], P=P), *run.states[1:]]) is None
    with monkeypatch.context() as patch:
        patch.setattr(run.kalman.plant, "settings", replace(run.kalman.plant.settings, constant_jerk=False))
        assert passed(run) is None
    monkeypatch.setattr("mbkf.filters.dynamic.information_pass.library", lambda: None)
    assert passed(run) is None
