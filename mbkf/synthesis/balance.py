"""Where the centre of mass must move so that the ground's pressure lies where it is wanted.

With h the height of the centre of mass c over the surface, F_z = m (g + ḧ) and L its angular momentum, the point of
zero moment is
x = c_x − (h m c̈_x + L̇_y) / F_z and y = c_y − (h m c̈_y − L̇_x) / F_z. Given x and y, h and L̇, this is a linear
equation for the curve c, solved by least squares on quintic splines, one per spell on the ground; the equations are a
band, so that the work grows with the time alone.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import sparse
from scipy.interpolate import BSpline
from scipy.linalg import null_space

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.synthesis.bands import BandedCholesky, spline_rows
from mbkf.synthesis.dual_numbers import Dual

DEGREE = 5


class HorizontalPath:
    """A curve (T, 2) made of quintic splines on the ground and straight uniform motion between them.

    Attributes:
        spells: (start, end) of each spell on the ground, s.
    """

    def __init__(self, spells: Sequence[tuple[float, float]], knot_s: float = 0.02) -> None:
        self.spells = list(spells)
        self.knots: list[Array] = []
        for start, end in self.spells:
            inner = np.linspace(start, end, max(2, round((end - start) / knot_s) + 1))
            self.knots.append(np.r_[[start] * DEGREE, inner, [end] * DEGREE])
        self.sizes = [len(knots) - DEGREE - 1 for knots in self.knots]
        self.first = np.cumsum([0, *self.sizes])
        self.coefficients = np.zeros((self.first[-1], 2))
        self._equations: _Equations | None = None

    def rows(self, spell: int, times: Array, order: int) -> sparse.csr_array:
        """(T, K) sparse rows that give a derivative of the curve from its K coefficients.

        Args:
            spell: Number of the spell on the ground.
            times: (T,) times inside it, s.
            order: Order of the derivative, 0 for the curve itself.
        """
        own = spline_rows(self.knots[spell], DEGREE, times, order)
        before, after = self.first[spell], self.first[-1] - self.first[spell + 1]
        none = [sparse.csr_array((len(times), int(count))) for count in (before, after)]
        return sparse.csr_array(sparse.hstack([none[0], own, none[1]]))

    def __call__(self, times: Array) -> Dual:
        """The curve (T, 2) with its derivatives."""
        orders = [np.zeros((len(times), 2)) for _ in range(3)]
        for k, (start, end) in enumerate(self.spells):
            own = self.coefficients[self.first[k] : self.first[k + 1]]
            spline = BSpline(self.knots[k], own, DEGREE)
            last = k + 1 == len(self.spells)
            inside = (times >= start if k else np.ones_like(times, bool)) & (
                np.ones_like(times, bool) if last else times <= end
            )
            for order in range(3):
                orders[order][inside] = spline(times[inside], nu=order)
            if not last:
                flying = (times > end) & (times < self.spells[k + 1][0])
                velocity = spline(end, nu=1)
                orders[0][flying] = spline(end) + (times[flying] - end)[:, None] * velocity
                orders[1][flying] = velocity
        return Dual(*orders)

    def _ties(self) -> Array:
        """(N, K) linear conditions: no horizontal force in the air, straight uniform motion from spell to spell."""
        ties = []
        for k in range(len(self.spells) - 1):
            end, start = np.array([self.spells[k][1]]), np.array([self.spells[k + 1][0]])
            ties += [
                self.rows(k, end, 2),
                self.rows(k + 1, start, 2),
                self.rows(k, end, 1) - self.rows(k + 1, start, 1),
                self.rows(k, end, 0) + (start - end) * self.rows(k, end, 1) - self.rows(k + 1, start, 0),
            ]
        return sparse.vstack(ties).toarray()

    def free(self) -> sparse.csr_array:
        """(K, J) orthonormal basis of the coefficients that keep the ties, which touch the ends of spells only."""
        every = sparse.eye_array(self.first[-1], format="csc")
        if len(self.spells) == 1:
            return every.tocsr()
        ties = self._ties()
        touched, rest = np.flatnonzero(ties.any(axis=0)), np.flatnonzero(~ties.any(axis=0))
        among = every[:, touched] @ sparse.csc_array(null_space(ties[:, touched]))
        before = rest < touched[0]
        return sparse.csr_array(sparse.hstack([every[:, rest[before]], among, every[:, rest[~before]]]))

    def solve(self, times: Array, target: Array, height: Dual, turning: Array) -> None:
        """Fits the curve to the wanted pressure.

        Args:
            times: (T,) s.
            target: (T, 2) wanted point of zero moment, m.
            height: (T,) height of the centre of mass over the surface, m; its second derivative is over the floor.
            turning: (T, 2) L̇_y / m and −L̇_x / m, m²/s².
        """
        if self._equations is None or self._equations.times is not times:
            self._equations = _Equations(self, times)
        rows, wanted = [], []
        for use, place, acceleration in self._equations.spells:
            lift = GRAVITY_M_S2 + height.second[use]
            weight = np.clip(lift, 0.0, None) / (np.clip(lift, 0.0, None) + 0.03 * GRAVITY_M_S2)
            safe = np.maximum(lift, 1e-3)
            pressed = place - sparse.diags_array(height.value[use] / safe) @ acceleration
            rows.append(sparse.diags_array(weight) @ pressed)
            wanted.append((target[use] + turning[use] / safe[:, None]) * weight[:, None])
        rows.append(3.0 * self._equations.ends)
        wanted.append(3.0 * target[[0, -1]])
        free = self._equations.free
        design = sparse.vstack(rows) @ free
        normal = design.T @ design
        small = 1e-12 * normal.diagonal().mean()
        fit = BandedCholesky(normal + small * sparse.eye_array(normal.shape[0]))
        self.coefficients = free @ fit.solve(design.T @ np.vstack(wanted))


class _Equations:
    """The part of a path's equations that depends on the times alone.

    Attributes:
        times: (T,) s.
        spells: Per spell (T,) which times belong to it, and sparse rows of the curve there and of its acceleration.
        ends: (2, K) rows of the curve at its first and last time.
        free: Basis of the coefficients that keep the ties.
    """

    def __init__(self, path: HorizontalPath, times: Array) -> None:
        self.times, self.free = times, path.free()
        self.spells = []
        for k, (start, end) in enumerate(path.spells):
            use = (times >= start) & (times <= end)
            self.spells.append((use, path.rows(k, times[use], 0), path.rows(k, times[use], 2)))
        ends = ((0, path.spells[0][0]), (len(path.spells) - 1, path.spells[-1][1]))
        self.ends = sparse.vstack([path.rows(k, np.array([at]), 0) for k, at in ends])
