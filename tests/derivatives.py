"""Framework of tests/test_jacobians.py: a case makes what states a derivative, and the numeric one beside it."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tests.motions import central_difference


@dataclass(frozen=True)
class Case:
    """Derivatives that one comparison checks: a random generator in, per name the stated and the numeric one out."""

    name: str
    names: tuple[str, ...]
    tolerance: float
    compare: Callable


DIRECTIONS = 20
"""Along so many a derivative by states of 150 components and more is compared."""

CASES: list[Case] = []
"""Filled by the modules derivatives_of_*."""


def checks(*names, tolerance=1e-7):
    def register(compare):
        CASES.append(Case(compare.__name__, names, tolerance, compare))
        return compare

    return register


def named(room, *pairs):
    """{room.name: (stated, numeric)}."""
    return {f"{room}.{name}": (stated, numeric) for name, stated, numeric in pairs}


def slope(function, x, step=1e-6):
    """Derivative of function(x) by a plain vector, appended as the last axis."""
    ends = [(np.asarray(function(x + step * e)), function(x - step * e)) for e in np.eye(len(x))]
    return np.stack([(a - b) / (2 * step) for a, b in ends], axis=-1)


def directions(size, rng):
    """(size, DIRECTIONS) orthogonal random directions: a wrong entry of a large matrix shows along any of them."""
    return np.linalg.qr(rng.normal(size=(size, DIRECTIONS)))[0] * np.sqrt(size / DIRECTIONS)


def along(model, function, q, step=1e-6):
    """Derivative (nv, nv) of a configuration-valued function(q) along the manifold."""
    centre = function(q)
    return central_difference(model, lambda at: model.difference(centre, function(at)), q, step)
