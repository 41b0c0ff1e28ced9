"""A block of one's own, as a user would write it: a tracker on the right hand whose origin drifts.

z = p(q) + b + r, r ~ N(0, σ² I₃), with p the hand's place and b a bias that is a random walk. The derivative and
contract tests find it without being told.
"""

from dataclasses import dataclass

import numpy as np

from mbkf.model.layout import ExtraState
from mbkf.sensors.block import Block, Rows
from mbkf.sensors.marker_sensor import MarkerSensor

READING, BIAS = "hand_tracker", "hand_tracker_bias"


@dataclass(frozen=True)
class TrackerSettings:
    """Noise σ of a reading, spread of the bias at the start, m, and its random walk, m/√s."""

    tracker_sd_m: float = 0.003
    bias_sd_m: float = 0.2
    bias_walk_m: float = 0.01


class DriftingTracker(Block):
    """Position of the right hand."""

    def __init__(self, model, settings=TrackerSettings()):
        self.settings = settings
        self._sensor = MarkerSensor(model, ["right_hand"], np.zeros((1, 3)))

    def states(self):
        s = self.settings
        return [ExtraState(BIAS, np.zeros(3), np.full(3, s.bias_sd_m), np.full(3, s.bias_walk_m))]

    def bind(self, layout, body):
        self._layout = layout

    def prepare(self, state, memory):
        return self._sensor.reading(state.q)

    def decide(self, at, frame, memory, notes):
        read = frame.readings.get(READING)
        return None if read is None or np.isnan(read).any() else read

    def linearise(self, at, decision):
        if decision is None:
            return None
        jacobian = np.zeros((3, self._layout.size))
        jacobian[:, self._layout.q] = at.prepared.jacobian[0]
        jacobian[:, self._layout[BIAS]] = np.eye(3)
        bias = at.state.extra[self._layout.extra_index(BIAS)]
        sd = self.settings.tracker_sd_m
        return Rows(jacobian / sd, (decision - at.prepared.positions_m[0] - bias) / sd, readings=3)

    def log_noise(self, decision):
        return 0.0 if decision is None else 6.0 * float(np.log(self.settings.tracker_sd_m))
