"""The body in the air: the pelvis turns so that the angular momentum about the centre of mass stays constant.

The pelvis's three angles are Chebyshev polynomials between take-off and touch-down, where their values are given. The
momentum L is linear in their rates; a quasi-Newton iteration on the rates makes it constant at the nodes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.polynomial.chebyshev import chebvander

from mbkf.conventions import Array
from mbkf.synthesis.curves import Curve, path
from mbkf.synthesis.dual_numbers import Dual
from mbkf.synthesis.plan import Flight

NODES = 150
SMALL = 1e-11
"""Change of the pelvis's rates at which the iteration ends, rad/s."""


class Tumbling:
    """Pelvis angles around and during a flight.

    Attributes:
        plan: Times, and the angles on the ground.
        times: (N,) nodes in the air, s.
        turns: Chebyshev polynomials of the angles about x, y and z.
    """

    def __init__(self, plan: Flight) -> None:
        self.plan = plan
        domain = (plan.take_off_s, plan.touch_down_s)
        self.times = Chebyshev.basis(NODES, domain=domain).roots().real
        self.turns = []
        for before, after in zip(plan.before, plan.after, strict=True):
            first, last = before[-1][1], after[0][1]
            self.turns.append(Chebyshev([0.5 * (first + last), 0.5 * (last - first)], domain=domain))
        self._response: Array | None = None

    def curves(self) -> tuple[Curve, Curve, Curve]:
        """The pelvis's angles about x, y, z over the whole motion, with continuous acceleration."""
        return tuple(self._curve(axis) for axis in range(3))  # type: ignore[return-value]

    def _curve(self, axis: int) -> Curve:
        turn, plan = self.turns[axis], self.plan
        rate, acceleration = turn.deriv(), turn.deriv(2)
        ends = [(t, turn(t), rate(t), acceleration(t)) for t in (plan.take_off_s, plan.touch_down_s)]
        before = path([*plan.before[axis][:-1], ends[0]])
        after = path([ends[1], *plan.after[axis][1:]])

        def curve(at: Array) -> Dual:
            rising, landed = before(at), after(at)
            inside = np.clip(at, plan.take_off_s, plan.touch_down_s)
            flying = (turn(inside), rate(inside), acceleration(inside))
            return Dual(
                *(
                    np.where(at < plan.take_off_s, b, np.where(at > plan.touch_down_s, a, f))
                    for b, f, a in zip(rising.orders, flying, landed.orders, strict=True)
                )
            )

        return curve

    def refine(self, momentum: Callable[[tuple[Dual, Dual, Dual]], Array], rounds: int) -> float:
        """Makes the momentum more constant.

        Args:
            momentum: (N, 3) angular momentum about the centre of mass at the nodes, from the pelvis's angles.
            rounds: Iterations.

        Returns:
            Largest change of a rate in the last iteration, rad/s.
        """
        change = np.inf
        for _ in range(rounds):
            angles = _angles(
                Dual(t(self.times), t.deriv()(self.times), t.deriv(2)(self.times)) for t in self.turns
            )
            now = momentum(angles)
            if self._response is None:
                self._response = np.stack(
                    [momentum(_faster(angles, axis)) - now for axis in range(3)], axis=-1
                )
            inverse: Array = np.asarray(np.linalg.inv(self._response), dtype=np.float64)
            drift = self._mean(np.einsum("tij,tj->ti", inverse, now))
            average: Array = self._mean(inverse.reshape(-1, 9)).reshape(3, 3)
            constant = np.linalg.inv(average) @ drift
            delta = np.einsum("tij,tj->ti", inverse, constant - now)
            domain = self.turns[0].domain
            for axis in range(3):
                self.turns[axis] = self.turns[axis] + self._through(delta[:, axis]).integ(lbnd=domain[0])
            change = float(np.abs(delta).max())
            if change < SMALL:
                break
        return change

    def _through(self, values: Array) -> Chebyshev:
        """The polynomial through (N,) values at the nodes; Chebyshev polynomials are orthogonal there."""
        domain = self.turns[0].domain
        basis = chebvander(2 * (self.times - domain[0]) / (domain[1] - domain[0]) - 1, NODES - 1)
        coefficients = 2 / NODES * basis.T @ values
        coefficients[0] /= 2
        return Chebyshev(coefficients, domain=domain)

    def _mean(self, values: Array) -> Array:
        domain = self.turns[0].domain
        fits = [self._through(column).integ(lbnd=domain[0]) for column in values.T]
        return np.array([fit(domain[1]) for fit in fits]) / (domain[1] - domain[0])


def _angles(three: Iterable[Dual]) -> tuple[Dual, Dual, Dual]:
    x, y, z = three
    return x, y, z


def _faster(angles: tuple[Dual, Dual, Dual], axis: int) -> tuple[Dual, Dual, Dual]:
    """The same angles, one of them turning 1 rad/s faster."""
    return _angles(Dual(a.value, a.first + (k == axis), a.second) for k, a in enumerate(angles))
