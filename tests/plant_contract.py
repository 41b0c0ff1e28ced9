"""What the tests of every plant share: how plants are found and made, and states on which they act.

A plant is a class that derives from :class:`mbkf.filters.plant.Plant`, in the package or in a module of tests/plants.
One whose constructor takes body, layout, time step and held dofs needs no line here.
"""

import importlib
import inspect
import pkgutil
from functools import lru_cache

import numpy as np

import mbkf.filters
import tests.plants
from mbkf.filters.dynamic.plant import DynamicState
from mbkf.filters.kinematic.plant import KinematicState, WhiteAccelerationPlant
from mbkf.filters.plant import Plant
from mbkf.filters.torque.plant import ForcedState, Scheme, TorquePlant
from mbkf.model.layout import ExtraState, Layout
from tests.derivatives import DIRECTIONS, directions, slope
from tests.derivatives_of_bodies import forced_body
from tests.dynamics import random_state
from tests.motions import random_model

DT = 0.01
HELD = "left_forearm"
"""The segment whose joint plants hold still in some tests."""

BIAS = ExtraState("bias", np.zeros(2), np.ones(2), np.array([0.3, 0.0]))


@lru_cache(None)
def plant_classes():
    """Every plant by its name."""
    for package in (mbkf.filters, tests.plants):
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            importlib.import_module(found.name)
    homes = ("mbkf.", "tests.plants.")
    return {
        kind.__name__: kind for kind in sorted(_below(Plant), key=str) if kind.__module__.startswith(homes)
    }


def _below(kind):
    for child in kind.__subclasses__():
        if not inspect.isabstract(child):
            yield child
        yield from _below(child)


def made(kind, rng, hold=False):
    """A plant of a kind for a random body, and a random state; ``hold`` asks it to hold some dofs still."""
    if kind is TorquePlant:
        return _forced(rng)
    model = random_model(rng)
    held = np.zeros(model.nv, dtype=bool)
    held[model.joint(HELD).v] = hold
    if kind is WhiteAccelerationPlant:
        plant = kind(model, DT, np.where(held, 0.0, model.acceleration_sd))
        return plant, KinematicState(*_motion(model, rng), _covariance(plant, rng))
    plant = kind(model, Layout.dynamic(model.nv, [BIAS]), DT, held)
    s = random_state(model, rng)
    return plant, DynamicState(s.q, s.v, s.a, s.w, _covariance(plant, rng), rng.normal(size=2))


def _motion(model, rng):
    s = random_state(model, rng)
    return s.q, s.v


def _forced(rng):
    """With F averaged over a short step of a fine integrator, exp(F Δt) is Φ to second order."""
    body, q, v, _, u = forced_body(rng)
    n = 2 * body.nv + body.nu
    noise = np.diag(np.concatenate([np.zeros(2 * body.nv), np.full(body.nu, 4.0)]))
    plant = TorquePlant(body, 1e-3, lambda _: noise, Scheme("RK4", mean_slope=True), wrenches=True)
    assert plant.layout.size == n
    return plant, ForcedState(q, v, u, _covariance(plant, rng))


def _covariance(plant, rng):
    """(N, N) in which everything depends on everything, in Fortran order."""
    n = plant.layout.size
    A = rng.normal(size=(n, n))
    return np.asfortranarray(1e-4 * (A @ A.T / n + 0.1 * np.eye(n)))


def tolerance(kind):
    """Share of the largest entry by which a stated transition may differ from the numeric one."""
    return 1e-4 if kind is TorquePlant else 1e-6


def transition(plant, state, rng):
    """Φ as the plant states it, and by finite differences along the manifold, in some random directions."""
    size = np.ones(plant.layout.size)
    size[plant.layout.v.stop :] = 10.0
    ways, end = directions(len(size), rng), plant.move(state)
    numeric = slope(
        lambda x: plant.difference(end, plant.move(plant.retract(state, size * (ways @ x), state.P))),
        np.zeros(DIRECTIONS),
    )
    return plant.transition(state) @ (size[:, None] * ways), numeric
