"""The body in the air: the pelvis turns so that the angular momentum about the centre of mass stays constant.

The pelvis's three angles are Chebyshev polynomials between take-off and touch-down, where their values are given. The
momentum L is linear in their rates; a quasi-Newton iteration on the rates makes it constant at the nodes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.polynomial.chebyshev import chebval, chebvander

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
        self._basis = chebvander(self._scaled(self.times), NODES - 1)
        even = np.arange(0, NODES, 2)
        self._share = 2 / NODES * self._basis[:, even] @ (1.0 / (1.0 - even**2) - 0.5 * (even == 0))

    def curves(self) -> tuple[Curve, Curve, Curve]:
        """The pelvis's angles about x, y, z over the whole motion, with continuous acceleration."""
        return tuple(self._curve(axis) for axis in range(3))  # type: ignore[return-value]

    def _curve(self, axis: int) -> Curve:
        turn, plan = self.turns[axis], self.plan
        ends = [(t, *self._orders(turn, t)) for t in (plan.take_off_s, plan.touch_down_s)]
        before = path([*plan.before[axis][:-1], ends[0]])
        after = path([ends[1], *plan.after[axis][1:]])

        def curve(at: Array) -> Dual:
            rising, landed = before(at), after(at)
            flying = (at >= plan.take_off_s) & (at <= plan.touch_down_s)
            turning = np.where(at < plan.take_off_s, rising.orders, landed.orders)
            turning[:, flying] = self._orders(turn, at[flying])
            return Dual.of(turning)

        return curve

    def _scaled(self, times: Array | float) -> Array:
        """Times, in s, from −1 at take-off to 1 at touch-down."""
        off, down = self.plan.take_off_s, self.plan.touch_down_s
        return np.asarray(2 * (times - off) / (down - off) - 1)

    def _orders(self, turn: Chebyshev, times: Array | float) -> Array:
        """(3, ...) an angle with its rate and acceleration, at times in s."""
        parts = [turn.coef, turn.deriv().coef, turn.deriv(2).coef]
        table = np.zeros((len(turn.coef), 3))
        for order, part in enumerate(parts):
            table[: len(part), order] = part
        return np.asarray(chebval(self._scaled(times), table))

    def refine(self, momentum: Callable[[tuple[Dual, Dual, Dual]], Array], rounds: int) -> float:
        """Makes the momentum more constant.

        Args:
            momentum: (N, 3) angular momentum about the centre of mass at the nodes, from the pelvis's angles and rates.
            rounds: Iterations.

        Returns:
            Largest change of a rate in the last iteration, rad/s.
        """
        change = np.inf
        for _ in range(rounds):
            angles = _angles(Dual.of(self._orders(turn, self.times)[:2]) for turn in self.turns)
            now = momentum(angles)
            if self._response is None:
                self._response = np.stack(
                    [momentum(_faster(angles, axis)) - now for axis in range(3)], axis=-1
                )
            inverse: Array = np.asarray(np.linalg.inv(self._response), dtype=np.float64)
            drift = self._share @ np.einsum("tij,tj->ti", inverse, now)
            constant = np.linalg.inv(np.einsum("t,tij->ij", self._share, inverse)) @ drift
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
        coefficients = 2 / NODES * self._basis.T @ values
        coefficients[0] /= 2
        return Chebyshev(coefficients, domain=self.turns[0].domain)


def _angles(three: Iterable[Dual]) -> tuple[Dual, Dual, Dual]:
    x, y, z = three
    return x, y, z


def _faster(angles: tuple[Dual, Dual, Dual], axis: int) -> tuple[Dual, Dual, Dual]:
    """The same angles, one of them turning 1 rad/s faster."""
    rates = np.eye(3)[axis]
    return _angles(Dual(a.value, a.first + rate) for a, rate in zip(angles, rates, strict=True))
