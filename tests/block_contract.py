"""What the tests of every block share: how blocks are found, shown a situation, and what their statements are.

A block is a class that derives from :class:`mbkf.sensors.block.Block`, in the package or in a module of tests/blocks.
It is made and shown frames by :mod:`tests.block_scenes`, so that a new one needs no line here unless its constructor
wants what no other wants.
"""

import copy
import importlib
import inspect
import pkgutil
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import lru_cache

import numpy as np

import mbkf
import tests.blocks
from mbkf.numerics.kalman import Information
from mbkf.sensors.block import Block, Frame, OperatingPoint, Rows
from tests.block_scenes import Situation, scene
from tests.derivatives import directions

HOMES = ("mbkf.", "tests.blocks.")

LITTLE, MOST_STEPS = 2e-4, 20
"""How much of what information says of a state is left when its slope is compared, and steps on the way there."""


INPUTS = {"GivenPlates": "tests/sensors/test_given_plates.py"}
"""Blocks that read nothing, since what they see enters the plant as an input, and where they are tested."""


@lru_cache(None)
def block_classes():
    """Every block that reads by its name; abstract ones, which no filter holds, are left out."""
    for package in (mbkf, tests.blocks):
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if not found.name.endswith("__main__"):
                importlib.import_module(found.name)
    found = {kind for kind in descendants(Block) if kind.__module__.startswith(HOMES)}
    kinds = {kind for kind in found if kind.__name__ not in INPUTS}
    return {kind.__name__: kind for kind in sorted(kinds, key=lambda kind: kind.__name__)}


def descendants(kind):
    for child in kind.__subclasses__():
        if not inspect.isabstract(child):
            yield child
        yield from descendants(child)


@dataclass(frozen=True)
class Shown:
    """A block that has lived through a situation up to its last frame, which it has decided upon.

    Attributes:
        block, plant: The block and a plant with its states.
        state: Where it is linearised.
        frame, memory: What it read and what it kept before.
        decision: What it took the readings for.
        situation: What happened.
    """

    block: Block
    plant: object
    state: object
    frame: Frame
    memory: object
    decision: object
    situation: Situation

    def says(self, state=None, decision=None):
        """Its statement, at its state or at another, as a smoother asks."""
        state = self.state if state is None else state
        at = OperatingPoint(state, self.block.prepare(state, None))
        return self.block.linearise(at, self.decision if decision is None else decision)

    def moved(self, x, state=None):
        """A state displaced by the first components of a tangent vector."""
        state = self.state if state is None else state
        step = np.zeros(self.plant.layout.size)
        step[: len(x)] = x
        return self.plant.retract(state, step, state.P)


@lru_cache(None)
def lived(kind, name, seed):
    """A block of a kind after all frames of a situation but the last, with its plant and what it then remembers."""
    here = scene(seed)
    happened, block = here.situation(name), here.made(kind)
    plant, memory = here.plant(block), block.begin()
    P = 1e-4 * np.eye(plant.layout.size)
    for t, (true, frame) in enumerate(zip(happened.motion[:-1], happened.frames[:-1], strict=True)):
        state = here.state(true, plant, P)
        at = OperatingPoint(state, block.prepare(state, memory))
        memory = block.remember(state, at, block.decide(at, frame, memory, happened.noted(t)), memory)
    return block, plant, memory


def shown(kind, name, seed=None, off=3):
    """A block of a kind after a situation.

    ``seed`` shuffles the instruments, ``off`` chooses how wrong the state is at which the block is linearised.
    """
    block, plant, memory = lived(kind, name, seed)
    memory = copy.deepcopy(memory)
    here = scene(seed)
    happened = here.situation(name)
    state, frame = here.near(happened.motion[-1], plant, off), happened.frames[-1]
    at = OperatingPoint(state, block.prepare(state, memory))
    decision = block.decide(at, frame, memory, happened.noted())
    return Shown(block, plant, state, frame, memory, decision, happened)


def all_rows(said):
    """The rows of a statement that consists of rows, one after the other; none of one that does not."""
    if said is None or isinstance(said, Information):
        return []
    return [said] if isinstance(said, Rows) else list(said)


def speaks(said):
    if isinstance(said, Information):
        return bool(np.any(said.matrix))
    return any(len(one.innovation) for one in all_rows(said))


def stacked(said, size):
    """(k, N) whitened rows and (k,) innovations of a statement; information as some rows that say the same."""
    if isinstance(said, Information):
        values, vectors = np.linalg.eigh(said.matrix)
        there = values > 1e-12 * values.max(initial=0.0)
        rows = vectors[:, there].T * np.sqrt(values[there])[:, None]
        innovation = vectors[:, there].T @ said.vector / np.sqrt(values[there])
        return np.pad(rows, ((0, 0), (0, size - len(said.vector)))), innovation
    parts = all_rows(said)
    widths = [(one.first, size - one.first - one.jacobian.shape[1]) for one in parts]
    rows = [np.pad(one.jacobian, ((0, 0), width)) for one, width in zip(parts, widths, strict=True)]
    if not rows:
        return np.zeros((0, size)), np.zeros(0)
    return np.vstack(rows), np.concatenate([one.innovation for one in parts])


def whole(said, size):
    """(N, N) information and (N,) vector of a statement."""
    rows, innovation = stacked(said, size)
    return rows.T @ rows, innovation @ rows


def derivative(found, rng, left_out=False, settled=False):
    """Stated slope and finite differences, along random tangent vectors.

    ``left_out``: they stay within the components that its rows hold. ``settled``: the rows are compared where little
    of their innovations is left, as information is.

    Rows fall by their Jacobian. The vector Hᵀ R⁻¹ y of information falls by its matrix where y vanishes, so the
    state is first moved to where little of it is left.
    """
    state, size, h = found.state, found.plant.layout.size, 1e-6
    said = found.says()
    if isinstance(said, Information):
        least = LITTLE * np.linalg.norm(said.vector)
        for _ in range(MOST_STEPS):
            if np.linalg.norm(said.vector) <= least:
                break
            state = found.moved(0.9 * np.linalg.pinv(said.matrix, 1e-9, True) @ said.vector, state)
            said = found.says(state)
        stated = np.pad(said.matrix, ((0, 0), (0, size - len(said.vector))))

        def value(x):
            return found.says(found.moved(x, state)).vector

    else:
        stated, y = stacked(said, size)
        least = LITTLE * np.linalg.norm(y)
        for _ in range(MOST_STEPS if settled else 0):
            if np.linalg.norm(y) <= least:
                break
            state = found.moved(0.9 * np.linalg.pinv(stated) @ y, state)
            stated, y = stacked(found.says(state), size)

        def value(x):
            return stacked(found.says(found.moved(x, state)), size)[1]

    steps = np.where(np.arange(size) < found.plant.layout.v.stop, 1.0, 1e3)
    if left_out:
        steps *= stated.any(axis=0)
    ways = steps[:, None] * directions(size, rng)
    columns = [(value(h * way) - value(-h * way)) / (2.0 * h) for way in ways.T]
    return stated @ ways, -np.stack(columns, axis=-1)


def noises(kind, here):
    """Changes that double a number of a block's constructor or settings, one at a time and all of them."""
    everything = {}
    for name, value in here.arguments(kind).items():
        if is_dataclass(value) and name.endswith("settings"):
            numbers = {one.name: getattr(value, one.name) for one in fields(value)}
            doubled = {leaf: 2.0 * number for leaf, number in numbers.items() if isinstance(number, float)}
            yield from ({name: replace(value, **{leaf: number})} for leaf, number in doubled.items())
            everything[name] = replace(value, **doubled)
        elif isinstance(value, float) or (isinstance(value, np.ndarray) and value.dtype.kind == "f"):
            yield {name: 2.0 * value}
            everything[name] = 2.0 * value
    yield everything


def noisier(decision):
    """Decisions with one of their own standard deviations doubled."""
    for name in getattr(decision, "_fields", ()):
        if "sd" in name.split("_"):
            yield decision._replace(**{name: 2.0 * getattr(decision, name)})
