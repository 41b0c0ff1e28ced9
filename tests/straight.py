"""A plant whose states are plain numbers that stay as they are, for tests of blocks and filters in a linear world."""

from dataclasses import dataclass, replace

import numpy as np

from mbkf.filters.plant import Plant
from mbkf.model.layout import Layout


@dataclass(frozen=True)
class StraightState:
    """Numbers q and extra; v is the same as q, so that every filter's state is served."""

    q: np.ndarray
    P: np.ndarray
    extra: np.ndarray

    @property
    def v(self):
        return self.q

    def retracted(self, model, step, P):
        size = len(self.q)
        return StraightState(self.q + step[:size], P, self.extra + step[size:])

    def minus(self, model, origin):
        return np.concatenate([self.q - origin.q, self.extra - origin.extra])


class StraightPlant(Plant):
    """q' = q + noise, and states that blocks add."""

    def __init__(self, size, sd=0.0, blocks=()):
        extras = [extra for block in blocks for extra in block.states()]
        super().__init__(None, Layout.of(size, q=size).with_extras(extras), 0.01)
        self.size, self._noise = size, np.zeros((self.layout.size,) * 2)
        self._noise[:size, :size] = sd**2 * np.eye(size)

    def move(self, state):
        return replace(state)

    def transition(self, state):
        return np.eye(self.layout.size)

    def noise(self, memory):
        return self._noise

    def start(self, sd=1.0):
        """Zeros of a standard deviation, and added states as their blocks say."""
        extra, extra_sd = self.layout.start()
        P = np.diag(np.concatenate([np.full(self.size, sd), extra_sd]) ** 2)
        return StraightState(np.zeros(self.size), P, extra)


def line(size):
    """A state of zeros with unit covariance."""
    return StraightPlant(size).start()
