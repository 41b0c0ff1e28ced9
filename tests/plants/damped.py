"""A plant of the tests' own: velocities fade, accelerations stay, and the noise grows while joints turn."""

from dataclasses import replace

import numpy as np

from mbkf.filters.plant import Plant


class Damped(Plant):
    """v' = v e^(−Δt/T) + a Δt, with a memory of the fastest joint."""

    def __init__(self, model, layout, dt_s, held, fades_s=0.3):
        super().__init__(model, layout, dt_s)
        self._fade = np.exp(-dt_s / fades_s)
        self._free = np.where(held, 0.0, 1.0)

    def begin(self):
        return 1.0

    def noise(self, memory):
        Q = np.zeros((self.layout.size,) * 2)
        for part, sd in ((self.layout.v, 0.5), (self.layout.a, 20.0 * memory)):
            Q[part, part] = self.dt_s * sd**2 * np.diag(self._free)
        return Q

    def remember(self, posterior, notes, memory):
        return 0.9 * memory + 0.1 * (1.0 + np.abs(posterior.v).max())

    def _moved(self, state):
        return self.dt_s * state.v + 0.5 * self.dt_s**2 * state.a

    def move(self, state):
        q = self.model.integrate(state.q, self._moved(state))
        return replace(state, q=q, v=self._fade * state.v + self.dt_s * state.a)

    def transition(self, state):
        q, v, a = self.layout.q, self.layout.v, self.layout.a
        phi, one = np.eye(self.layout.size), np.eye(self.model.nv)
        phi[q, q], by_step = self.model.integration_derivatives(state.q, self._moved(state))
        phi[q, v], phi[q, a] = self.dt_s * by_step, 0.5 * self.dt_s**2 * by_step
        phi[v, v], phi[v, a] = self._fade * one, self.dt_s * one
        return phi
