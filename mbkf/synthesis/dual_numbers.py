"""Functions of time carried with their exact first and second derivatives (second-order dual numbers).

Value and derivatives are one array, so that one operation of numpy works on all of them. It has the shape (n, T, ...),
but lies in memory with T last: numpy's loops then run along the frames, several times as fast as along rows of three.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from types import EllipsisType
from typing import TypeAlias

import numpy as np

from mbkf.conventions import Array

Index: TypeAlias = int | slice | EllipsisType | tuple[int | slice | EllipsisType | None, ...]
"""An index of a dual number's arrays."""


class Dual:
    """An array quantity x(t) sampled at T times, with ẋ and ẍ; arithmetic follows the chain rule exactly.

    A dual number may lack ẍ, or ẋ as well; then it costs less, and results of it lack the same.

    Attributes:
        orders: (n, T, ...) x, ẋ per second, ẍ per second squared; n is 3, or less where derivatives are lacking.
    """

    __array_ufunc__ = None  # an array on the left leaves the arithmetic to the dual number
    __slots__ = ("orders",)

    def __init__(self, *orders: Array) -> None:
        """A quantity from its value and its derivatives, (T, ...) each."""
        self.orders = _reversed(np.array([order.T for order in orders]))

    @classmethod
    def of(cls, orders: Array) -> Dual:
        """The dual number that has this array; it is not copied."""
        made = cls.__new__(cls)
        made.orders = orders
        return made

    @classmethod
    def constant(cls, value: Array) -> Dual:
        """A dual number that does not change."""
        array = np.asarray(value, dtype=float)
        rest = np.zeros_like(array)
        return cls(array, rest, rest)

    @property
    def value(self) -> Array:
        """(T, ...) x."""
        return self.orders[0]

    @property
    def first(self) -> Array:
        """(T, ...) ẋ, per second."""
        return self.orders[1]

    @property
    def second(self) -> Array:
        """(T, ...) ẍ, per second squared."""
        return self.orders[2]

    def upto(self, order: int) -> Dual:
        """The quantity cut at an order of its derivatives; order 0 is the value."""
        return Dual.of(self.orders[: order + 1])

    def __getitem__(self, index: Index) -> Dual:
        return Dual.of(self.orders[(slice(None), *(index if isinstance(index, tuple) else (index,)))])

    def __neg__(self) -> Dual:
        return Dual.of(-self.orders)

    def __add__(self, other: Dual | Array | float) -> Dual:
        if isinstance(other, Dual):
            n = min(len(self.orders), len(other.orders))
            return Dual.of(self.orders[:n] + other.orders[:n])
        moved = self.orders + np.zeros_like(other)
        moved[0] += other
        return Dual.of(moved)

    __radd__ = __add__

    def __sub__(self, other: Dual | Array | float) -> Dual:
        if isinstance(other, Dual):
            n = min(len(self.orders), len(other.orders))
            return Dual.of(self.orders[:n] - other.orders[:n])
        return self + (-other)

    def __rsub__(self, other: Array | float) -> Dual:
        return (-self) + other

    def __mul__(self, other: Dual | Array | float) -> Dual:
        if isinstance(other, Dual):
            return product(np.multiply, self, other)
        return Dual.of(self.orders * other)

    __rmul__ = __mul__

    def __truediv__(self, other: Dual | Array | float) -> Dual:
        return self * (1.0 / other) if isinstance(other, Dual) else Dual.of(self.orders / other)

    def __rtruediv__(self, other: float) -> Dual:
        inverse = 1.0 / self.value
        square = inverse * inverse
        return self.chain(inverse, -square, 2.0 * square * inverse) * other

    def __matmul__(self, other: Dual) -> Dual:
        """Matrix product of (T, m, n) and (T, n, p)."""
        return product(_matrix_product, self, other)

    def chain(self, f: Array, df: Array, ddf: Array) -> Dual:
        """The dual number f(x) by the chain rule.

        Args:
            f: (T, ...) f(x).
            df: (T, ...) f′(x).
            ddf: (T, ...) f″(x).
        """
        made = df * self.orders
        made[0] = f
        if len(made) > 2:
            made[2] += ddf * self.first**2
        return Dual.of(made)

    def transposed(self) -> Dual:
        """The last two axes exchanged."""
        return Dual.of(np.swapaxes(self.orders, -1, -2))

    def apply(self, vector: Dual | Array) -> Dual:
        """Matrix times vector: (T, 3, 3) on (T, 3), or on one constant (3,)."""
        if isinstance(vector, Dual):
            return product(_matrix_vector, self, vector)
        return Dual.of(_matrix_vector(self.orders, vector))

    def sum(self, axis: int) -> Dual:
        """Sum along an axis, counted from the last."""
        return Dual.of(self.orders.sum(axis=axis))


def product(bilinear: Callable[[Array, Array], Array], a: Dual, b: Dual) -> Dual:
    """A bilinear product of two dual numbers by the product rule.

    Args:
        bilinear: Product of arrays, of each pair along their leading axes.
        a: The left factor.
        b: The right factor.
    """
    n = min(len(a.orders), len(b.orders))
    x, y = a.orders[:n], b.orders[:n]
    made = bilinear(x[0], y)
    if n > 1:
        made[1:] += bilinear(x[1:], y[0])
    if n > 2:
        made[2] += 2.0 * bilinear(x[1], y[1])
    return Dual.of(made)


def sin(x: Dual) -> Dual:
    """Sine of a dual number."""
    s, c = np.sin(x.value), np.cos(x.value)
    return x.chain(s, c, -s)


def cos(x: Dual) -> Dual:
    """Cosine of a dual number."""
    s, c = np.sin(x.value), np.cos(x.value)
    return x.chain(c, -s, -c)


def sqrt(x: Dual) -> Dual:
    """Square root of a positive dual number."""
    root = np.sqrt(x.value)
    return x.chain(root, 0.5 / root, -0.25 / (root * x.value))


def arccos(x: Dual) -> Dual:
    """Arc cosine of a dual number inside (−1, 1)."""
    rest = 1 - x.value**2
    slope = -1 / np.sqrt(rest)
    return x.chain(np.arccos(x.value), slope, slope * x.value / rest)


def dot(a: Dual, b: Dual) -> Dual:
    """(T,) inner product of two (T, 3) dual numbers."""
    return product(_inner, a, b)


def cross(a: Dual, b: Dual | Array) -> Dual:
    """(T, 3) vector product of two (T, 3) dual numbers, or with one constant (3,) on the right."""
    if isinstance(b, Dual):
        return product(vector_product, a, b)
    return Dual.of(vector_product(a.orders, b))


def unit(a: Dual) -> Dual:
    """(T, 3) direction of a (T, 3) dual number."""
    square = dot(a, a)
    f = 1.0 / np.sqrt(square.value)
    df = -0.5 * f / square.value
    return a * square.chain(f, df, -1.5 * df / square.value)[..., None]


def stack(parts: Sequence[Dual]) -> Dual:
    """Several dual numbers of one shape (T, ...) along a new last axis."""
    n = min(len(part.orders) for part in parts)
    rows = np.array([_reversed(part.orders[:n]) for part in parts])
    return Dual.of(_reversed(np.swapaxes(rows, 0, 1)))


def where(condition: np.ndarray, a: Dual, b: Dual) -> Dual:
    """One of two dual numbers, sample by sample.

    Args:
        condition: (T,) where to take a.
        a: (T, ...) taken where the condition holds.
        b: (T, ...) taken elsewhere.
    """
    mask = condition.reshape(condition.shape + (1,) * (a.value.ndim - 1))
    n = min(len(a.orders), len(b.orders))
    return Dual.of(np.where(mask, a.orders[:n], b.orders[:n]))


def rotation(axis: int, angle: Dual) -> Dual:
    """(T, ..., 3, 3) rotation by a (T, ...) angle in rad about axis 0, 1 or 2."""
    s, c = np.sin(angle.value), np.cos(angle.value)
    return turned(axis, angle.chain(c, -s, -c), angle.chain(s, c, -s))


def turned(axis: int, cosine: Dual, sine: Dual) -> Dual:
    """(T, ..., 3, 3) rotation by an angle whose cosine and sine are known.

    Args:
        axis: 0, 1 or 2.
        cosine: (T, ...) of the angle.
        sine: (T, ...) of the angle.
    """
    after, last = (axis + 1) % 3, (axis + 2) % 3
    along, across = _reversed(cosine.orders), _reversed(sine.orders)
    matrix = np.zeros((3, 3, *along.shape))
    matrix[axis, axis, 0] = 1.0
    matrix[after, after] = matrix[last, last] = along
    matrix[after, last], matrix[last, after] = across, -across  # column, row
    return Dual.of(_reversed(np.moveaxis(matrix, 2, 0)))


def euler(about_xyz: Iterable[Dual], order: str = "yxz") -> Dual:
    """(T, ..., 3, 3) product of rotations by the (T, ...) angles about x, y and z, rad, in the given order."""
    angles = dict(zip("xyz", about_xyz, strict=True))
    product = rotation("xyz".index(order[0]), angles[order[0]])
    for axis in order[1:]:
        product = product @ rotation("xyz".index(axis), angles[axis])
    return product


def local_rates(rotations: Dual) -> tuple[Array, Array]:
    """(T, 3) angular velocity and its derivative in the rotating frame: ω = (Rᵀ Ṙ)ˇ, ω̇ = (Rᵀ R̈)ˇ."""
    rates = axial(_matrix_product(np.swapaxes(rotations.value, -1, -2), rotations.orders[1:]))
    return rates[0], rates[1]


def axial(matrix: Array) -> Array:
    """(..., 3) vector of the antisymmetric part of (..., 3, 3) matrices."""
    return 0.5 * np.stack(
        [
            matrix[..., 2, 1] - matrix[..., 1, 2],
            matrix[..., 0, 2] - matrix[..., 2, 0],
            matrix[..., 1, 0] - matrix[..., 0, 1],
        ],
        axis=-1,
    )


def _matrix_product(x: Array, y: Array) -> Array:
    return np.asarray(np.einsum("...ij,...jk->...ik", x, y))


def _matrix_vector(x: Array, y: Array) -> Array:
    return np.asarray(np.einsum("...ij,...j->...i", x, y))


def _inner(x: Array, y: Array) -> Array:
    return np.asarray(np.einsum("...i,...i->...", x, y))


def vector_product(x: Array, y: Array) -> Array:
    """Vector products along the last axis; :func:`numpy.cross` is slow where frames lie last in memory."""
    a, b, c = (x[..., k] for k in range(3))
    d, e, f = (y[..., k] for k in range(3))
    return np.moveaxis(np.array([b * f - c * e, c * d - a * f, a * e - b * d]), 0, -1)


def _reversed(orders: Array) -> Array:
    """(n, T, ...) as a view (n, ..., T), and back: all axes but the first in reversed order."""
    return orders.transpose(0, *range(orders.ndim - 1, 0, -1))
