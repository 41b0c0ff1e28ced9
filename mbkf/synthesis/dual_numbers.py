"""Functions of time carried with their exact first and second derivatives (second-order dual_numbers).

Small vectors and matrices over many frames have shape (T, ...) but lie in memory with T last, where this module makes
them: numpy's loops then run along the frames, several times as fast as along rows of three.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from types import EllipsisType
from typing import TypeAlias

import numpy as np

from mbkf.conventions import Array

Index: TypeAlias = int | slice | EllipsisType | tuple[int | slice | EllipsisType | None, ...]
"""An index of a dual number's arrays."""


class Dual:
    """An array quantity x(t) sampled at T times, with ẋ and ẍ; arithmetic follows the chain rule exactly.

    Attributes:
        value: (T, ...) x.
        first: (T, ...) ẋ, per second.
        second: (T, ...) ẍ, per second squared.
    """

    __array_ufunc__ = None  # an array on the left leaves the arithmetic to the dual number
    __slots__ = ("first", "second", "value")

    def __init__(self, value: Array, first: Array, second: Array) -> None:
        self.value, self.first, self.second = value, first, second

    @classmethod
    def constant(cls, value: Array) -> Dual:
        """A dual number that does not change."""
        array = np.asarray(value, dtype=float)
        return cls(array, np.zeros_like(array), np.zeros_like(array))

    @property
    def orders(self) -> tuple[Array, Array, Array]:
        """x, ẋ, ẍ."""
        return self.value, self.first, self.second

    def __getitem__(self, index: Index) -> Dual:
        return Dual(*(x[index] for x in self.orders))

    def __neg__(self) -> Dual:
        return Dual(*(-x for x in self.orders))

    def __add__(self, other: Dual | Array | float) -> Dual:
        if isinstance(other, Dual):
            return Dual(*(x + y for x, y in zip(self.orders, other.orders, strict=True)))
        return Dual(self.value + other, self.first + 0.0 * other, self.second + 0.0 * other)

    __radd__ = __add__

    def __sub__(self, other: Dual | Array | float) -> Dual:
        return self + (-other)

    def __rsub__(self, other: Array | float) -> Dual:
        return (-self) + other

    def __mul__(self, other: Dual | Array | float) -> Dual:
        if isinstance(other, Dual):
            return Dual(
                self.value * other.value,
                self.first * other.value + self.value * other.first,
                self.second * other.value + 2 * self.first * other.first + self.value * other.second,
            )
        return Dual(*(x * other for x in self.orders))

    __rmul__ = __mul__

    def __truediv__(self, other: Dual | Array | float) -> Dual:
        if isinstance(other, Dual):
            inverse = 1 / other.value
            square = inverse * inverse
            return self * other.chain(inverse, -square, 2 * square * inverse)
        return Dual(*(x / other for x in self.orders))

    def __matmul__(self, other: Dual) -> Dual:
        """Matrix product of (T, m, n) and (T, n, p)."""
        return self._product("tij,tjk->tik", other)

    def _product(self, indices: str, other: Dual) -> Dual:
        """The Einstein sum of two dual numbers by the product rule."""

        def product(x: Array, y: Array) -> Array:
            return np.asarray(np.einsum(indices, x, y))

        return Dual(
            product(self.value, other.value),
            product(self.first, other.value) + product(self.value, other.first),
            product(self.second, other.value)
            + 2 * product(self.first, other.first)
            + product(self.value, other.second),
        )

    def chain(self, f: Array, df: Array, ddf: Array) -> Dual:
        """The dual number f(x) by the chain rule.

        Args:
            f: (T, ...) f(x).
            df: (T, ...) f′(x).
            ddf: (T, ...) f″(x).
        """
        return Dual(f, df * self.first, ddf * self.first**2 + df * self.second)

    def transposed(self) -> Dual:
        """The last two axes exchanged."""
        return Dual(*(np.swapaxes(x, -1, -2) for x in self.orders))

    def apply(self, vector: Dual | Array) -> Dual:
        """Matrix times vector: (T, 3, 3) on (T, 3), or on one constant (3,)."""
        if isinstance(vector, Dual):
            return self._product("tij,tj->ti", vector)
        return Dual(*(np.einsum("tij,j->ti", x, vector) for x in self.orders))

    def sum(self, axis: int) -> Dual:
        """Sum along an axis."""
        return Dual(*(x.sum(axis=axis) for x in self.orders))


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
    return (a * b).sum(axis=-1)


def cross(a: Dual, b: Dual) -> Dual:
    """(T, 3) vector product of two (T, 3) dual numbers."""
    x, y = ([one[..., k] for k in range(3)] for one in (a, b))
    return stack([x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]])


def unit(a: Dual) -> Dual:
    """(T, 3) direction of a (T, 3) dual number."""
    length = sqrt(dot(a, a))
    return a / length[..., None]


def stack(parts: Sequence[Dual]) -> Dual:
    """Several dual numbers of one shape (T, ...) along a new last axis."""
    orders = zip(*(part.orders for part in parts), strict=True)
    return Dual(*(np.stack([x.T for x in one]).T for one in orders))


def where(condition: np.ndarray, a: Dual, b: Dual) -> Dual:
    """One of two dual numbers, sample by sample.

    Args:
        condition: (T,) where to take a.
        a: (T, ...) taken where the condition holds.
        b: (T, ...) taken elsewhere.
    """
    mask = condition.reshape(condition.shape + (1,) * (a.value.ndim - 1))
    return Dual(*(np.where(mask, x, y) for x, y in zip(a.orders, b.orders, strict=True)))


def rotation(axis: int, angle: Dual) -> Dual:
    """(T, 3, 3) rotation by a (T,) angle in rad about axis 0, 1 or 2."""
    s, c = np.sin(angle.value), np.cos(angle.value)
    return turned(axis, angle.chain(c, -s, -c), angle.chain(s, c, -s))


def turned(axis: int, cosine: Dual, sine: Dual) -> Dual:
    """(T, 3, 3) rotation by an angle whose cosine and sine are known.

    Args:
        axis: 0, 1 or 2.
        cosine: (T,) of the angle.
        sine: (T,) of the angle.
    """
    orders = zip(cosine.orders, sine.orders, (1.0, 0.0, 0.0), strict=True)
    return Dual(*(_about(axis, *one) for one in orders))


def _about(axis: int, along: Array, across: Array, fixed: float) -> Array:
    """(T, 3, 3) matrices with (T,) cosines ``along``, sines ``across`` and one fixed entry on the axis."""
    after, last = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.zeros((3, 3, len(along)))
    matrix[axis, axis] = fixed
    matrix[after, after], matrix[last, last] = along, along
    matrix[last, after], matrix[after, last] = across, -across
    return matrix.transpose(2, 0, 1)


def euler(about_xyz: Iterable[Dual], order: str = "yxz") -> Dual:
    """(T, 3, 3) product of elementary rotations by the angles about x, y and z, in the given order."""
    angles = dict(zip("xyz", about_xyz, strict=True))
    product = rotation("xyz".index(order[0]), angles[order[0]])
    for axis in order[1:]:
        product = product @ rotation("xyz".index(axis), angles[axis])
    return product


def local_rates(rotations: Dual) -> tuple[Array, Array]:
    """(T, 3) angular velocity and its derivative in the rotating frame: ω = (Rᵀ Ṙ)ˇ, ω̇ = (Rᵀ R̈)ˇ."""
    first, second = (np.einsum("tji,tjk->tik", rotations.value, x) for x in rotations.orders[1:])
    return axial(first), axial(second)


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
