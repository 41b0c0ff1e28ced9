"""A plant whose states are plain numbers that stay as they are, for tests of blocks and filters in a linear world."""

from dataclasses import dataclass, replace

import numpy as np

from mbkf.sensors.layout import Layout


@dataclass(frozen=True)
class StraightState:
    """Numbers q and extra; v is the same as q, so that every filter's state is served."""

    q: np.ndarray
    P: np.ndarray
    extra: np.ndarray

    @property
    def v(self):
        return self.q


class StraightPlant:
    """q' = q + noise, and states that blocks add."""

    dt_s, model = 0.01, None

    def __init__(self, size, sd=0.0, blocks=()):
        extras = [extra for block in blocks for extra in block.states()]
        self.size, self.layout = size, Layout.of(size, q=size).with_extras(extras)
        self._noise = np.concatenate([np.full(size, sd**2), self.layout.walk_variance(self.dt_s)])

    def begin(self):
        return None

    def noise(self, memory):
        return self._noise

    def predict(self, state, noise):
        return replace(state, P=np.asfortranarray(state.P + np.diag(noise)))

    def transition(self, state):
        return np.eye(self.layout.size)

    def retract(self, state, step, P):
        return StraightState(state.q + step[: self.size], P, state.extra + step[self.size :])

    def difference(self, origin, state):
        return np.concatenate([state.q - origin.q, state.extra - origin.extra])

    def remember(self, posterior, notes, memory):
        return None

    def start(self, sd=1.0):
        """Zeros of a standard deviation, and added states as their blocks say."""
        extra, extra_sd = self.layout.start()
        P = np.diag(np.concatenate([np.full(self.size, sd), extra_sd]) ** 2)
        return StraightState(np.zeros(self.size), P, extra)


def line(size):
    """A state of zeros with unit covariance."""
    return StraightPlant(size).start()
