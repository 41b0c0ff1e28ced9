"""Consistency of the dynamic filter and smoother on motions made by the filter's own plant.

Matched exactly: start, Singer accelerations, white markers and plates, and the residual with its decay, all with the
noise the filter assumes. Truth obeys Newton's law: the residual is drawn, and the two wrenches follow from the motion,
shared between the feet along a sine. A random walk cannot do that, so theirs is made wide enough (10 kN a frame) to be
no information; the 12 innovations of their readings are then 0 by comparison, and NIS counts the others. Posture,
limits and gate are made harmless, and feet are measured always. What remains is the filter's own linearisation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import cast

import numpy as np

from benchmarks.checks import Check, within
from benchmarks.dynamic.methods import Mapper
from benchmarks.dynamic.nis import nis
from mbkf.conventions import Array
from mbkf.filters.dynamic.filter import DynamicFilter, dynamic_blocks
from mbkf.filters.dynamic.plant import DynamicState, SingerPlant
from mbkf.filters.dynamic.settings import DynamicSettings
from mbkf.filters.dynamic.smoother import smooth
from mbkf.filters.settings import changed
from mbkf.model.human import HumanModel
from mbkf.model.newton_euler import NewtonEuler
from mbkf.model.protocol import load_protocol
from mbkf.numerics.threads import single_threaded
from mbkf.sensors.block import Frame
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.contact.records import Contact, ContactDecision, ContactMemory, KeptContact
from mbkf.sensors.contact.soles import sole_points
from mbkf.sensors.marker_sensor import MarkerSensor

DT_S, MARKER_SD_M, FRAMES = 0.01, 0.001, 60
RUNS, SMOOTHED_RUNS = 20, 8
QUANTITIES = ("positions", "velocities", "torques")
_TWO_SIDED_95 = 1.959964
_UNKNOWN_WRENCH = 1e4

SETTINGS = changed(
    DynamicSettings(),
    acceleration_scale=0.1,
    activity_gain=0.0,
    innovation_share=0.0,
    posture_scale=1e6,
    limit_sd_rad=1e6,
    gate=1e12,
    gate_radius_m=10.0,
    wrench_force=1e5,
    wrench_moment=1e5,
)


@dataclass(frozen=True)
class Judged:
    """Errors of one frame's estimate relative to its covariance.

    Attributes:
        ratios: Per quantity of QUANTITIES its errors over their standard deviations (n,).
        nees: Per quantity the error squared with the whole covariance, per dof.
    """

    ratios: tuple[Array, Array, Array]
    nees: tuple[float, float, float]


@dataclass(frozen=True)
class Run:
    """One simulated motion, filtered and, where asked, smoothed.

    Attributes:
        filtered: One per frame.
        smoothed: One per frame; none where not asked for.
        nis, readings: Normalised innovation squared and readings of each frame.
    """

    filtered: tuple[Judged, ...]
    smoothed: tuple[Judged, ...]
    nis: Array
    readings: Array


class AlwaysMeasured(ContactDetector):
    """Two feet that stay on their plates whatever the body does."""

    def __init__(self, centres_m: Array) -> None:
        self.centres_m = centres_m

    def begin(self) -> ContactMemory:
        """Nothing to remember."""
        return ContactMemory((), (), float("nan"), (0.0, 0.0))

    def decide(
        self,
        memory: KeptContact,
        q: Array,  # noqa: ARG002
        v: Array,  # noqa: ARG002
        a: Array,  # noqa: ARG002
        plate_wrench: Array,
        supported: bool = False,  # noqa: ARG002
    ) -> ContactDecision:
        """Each foot on its own plate.

        Args:
            memory: Returned as it is.
            q: Not used.
            v: Not used.
            a: Not used.
            plate_wrench: (2, 6) wrenches of the two plates.
            supported: Not used.
        """
        return ContactDecision((Contact.MEASURED,) * 2, plate_wrench, self.centres_m, False, memory)


class OwnPlant:
    """A person in the reference posture who moves as the filter's plant does."""

    def __init__(self) -> None:
        self.model = HumanModel.scaled()
        self.balance = NewtonEuler(self.model)
        self.q = self.model.neutral()
        self.q[2] -= sole_points(self.model, self.q[None])[0, :, :2, 2].min()
        self.centres_m = sole_points(self.model, self.q[None])[0].mean(axis=1)
        law, plates = SETTINGS.law, SETTINGS.contact
        self.law_sd = np.repeat([law.residual_force_n, law.residual_moment_nm], 3)
        self.plate_sd = np.repeat([plates.plate_force_n, plates.plate_moment_nm], 3)
        noise = np.full(len(self._sensor.segments), MARKER_SD_M)
        unobservable, feet = np.zeros(self.model.nv, dtype=bool), AlwaysMeasured(self.centres_m)
        blocks = dynamic_blocks(self._sensor, noise, feet, DT_S, unobservable, SETTINGS)
        self.kalman = DynamicFilter(self._sensor, noise, DT_S, unobservable, SETTINGS, blocks)
        self.plant = cast("SingerPlant", self.kalman.plant)
        (self.residual,) = self.plant.layout.extras
        # as later frames read zero, too, the whole trial's process has half of the filter's variance
        self.residual_sd = self.residual.start_sd / np.sqrt(2.0)

    @cached_property
    def _sensor(self) -> MarkerSensor:
        markers = load_protocol("reference36").markers
        local = np.array([m.position_m for m in markers])
        return MarkerSensor(self.model, [m.segment for m in markers], local)

    def start(self) -> DynamicState:
        """What the filter starts from, before the first frame."""
        nv, accelerations = self.model.nv, self.plant.acceleration_sd
        wrench, residual = np.full(12, _UNKNOWN_WRENCH), self.residual.start_sd
        sd = np.concatenate([np.repeat([0.01, 0.1], nv), accelerations, wrench, residual])
        still = np.zeros(nv)
        return DynamicState(self.q, still, still, np.zeros(12), np.diag(sd**2), np.zeros(6))

    def drawn(self, start: DynamicState, rng: np.random.Generator) -> DynamicState:
        """A true state before the first frame, drawn from the start's covariance."""
        sd = np.sqrt(np.diag(start.P))[: 3 * self.model.nv]
        moved = np.concatenate(
            [sd * rng.normal(size=len(sd)), np.zeros(12), self.residual_sd * rng.normal(size=6)]
        )
        return self.kalman.plant.retract(start, moved, start.P)

    def moved(self, state: DynamicState, share: float, rng: np.random.Generator) -> DynamicState:
        """The plant's next true state with its noise.

        Args:
            state: The true state.
            share: Share of the load on the right foot, 0 to 1.
            rng: Source of the noise.
        """
        plant = self.plant
        per_noise = np.sqrt(np.diag(plant.covariance))
        noise = np.outer(per_noise, plant.acceleration_sd * rng.normal(size=self.model.nv))
        planned = self.model.integrate(state.q, plant.dt_s * state.v + plant.c2 * state.a)
        q = self.model.integrate(planned, noise[0])
        v, a = state.v + plant.c1 * state.a + noise[1], plant.rho * state.a + noise[2]
        root = self.balance.root(q, v, a, np.zeros(12))
        kept = np.exp(-2.0 * DT_S / SETTINGS.residual.residual_memory_s)
        fresh = self.residual_sd * np.sqrt(1.0 - kept**2) * rng.normal(size=6)
        residual = kept * state.extra + fresh
        unbalanced = root.residual + residual + self.law_sd * rng.normal(size=6)
        total = np.linalg.solve(-root.by_state[:, -6:], unbalanced)
        return DynamicState(
            q, v, a, np.concatenate([share * total, (1.0 - share) * total]), state.P, residual
        )

    def readings(self, true: DynamicState, rng: np.random.Generator) -> Frame:
        """Markers and plates, noise of the latter about the soles."""
        markers = self.kalman.sensor.positions(true.q)
        markers = markers + MARKER_SD_M * rng.normal(size=markers.shape)
        noise = self.plate_sd * rng.normal(size=(2, 6))
        noise[:, 3:] += np.cross(self.centres_m, noise[:, :3])
        return Frame(markers, true.w.reshape(2, 6) + noise)

    def judged(self, true: DynamicState, found: DynamicState) -> Judged:
        """Errors relative to the estimate's covariance."""
        nv = self.model.nv
        e, P = self.kalman.plant.difference(found, true), found.P
        joint = self.balance.torques(found.q, found.v, found.a, found.w)
        T = joint.by_state[6:]
        tau = self.balance.tau(true.q, true.v, true.a, true.w)[6:] - joint.tau[6:]
        rates = slice(nv, 2 * nv)
        known = T.shape[1]
        torques = (tau, T @ P[:known, :known] @ T.T)
        parts = ((e[:nv], P[:nv, :nv]), (e[rates], P[rates, rates]), torques)
        q, v, t = [(x / np.sqrt(np.diag(C)), float(x @ np.linalg.solve(C, x)) / len(x)) for x, C in parts]
        return Judged((q[0], v[0], t[0]), (q[1], v[1], t[1]))


def simulate(seed: int, *, smoothed: bool = False) -> Run:
    """A motion of FRAMES frames, followed by the filter and, if asked, smoothed."""
    with single_threaded():
        person, rng = OwnPlant(), np.random.default_rng(seed)
        state, memory = person.start(), person.kalman.begin()
        true, truth, steps, filtered, squared = person.drawn(state, rng), [], [], [], []
        for t in range(FRAMES):
            true = person.moved(true, 0.5 + 0.3 * np.sin(0.1 * t), rng)
            step = person.kalman.step(state, memory, person.readings(true, rng))
            state, memory = step.state, step.memory
            truth.append(true)
            filtered.append(person.judged(true, state))
            squared.append(nis(step))
            if smoothed:
                steps.append(step)
        later = smooth(person.kalman, steps, rounds=2) if smoothed else []
        after = tuple(person.judged(*pair) for pair in zip(truth, later, strict=smoothed))
    return Run(tuple(filtered), after, *map(np.array, zip(*squared, strict=True)))


def ratios_of(estimates: Sequence[Sequence[Judged]], quantity: int) -> Array:
    """(runs, frames, n) errors over standard deviations."""
    return np.array([[judged.ratios[quantity] for judged in run] for run in estimates])


def nees_of(estimates: Sequence[Sequence[Judged]], quantity: int) -> Array:
    """(runs, frames) NEES per dof with the whole covariance."""
    return np.array([[judged.nees[quantity] for judged in run] for run in estimates])


def own_plant_rows(mapper: Mapper, *, quick: bool = False) -> list[Check]:
    """NEES per dof, coverage and NIS of filter and smoother."""
    shared = 3 if quick else SMOOTHED_RUNS
    runs = mapper(partial(simulate, smoothed=True), range(shared))
    if not quick:
        runs += mapper(simulate, range(shared, RUNS))
    label = "matched noise, motions of the filter's own plant"
    rows = _rows(f"{label}: dynamic", [run.filtered for run in runs])
    rows += _rows(f"{label}: dynamic, smoothed", [run.smoothed for run in runs[:shared]])
    innovations = sum(run.nis.sum() for run in runs) / sum((run.readings - 12).sum() for run in runs)
    return rows + within(f"{label}: dynamic, NIS per reading", float(innovations), 0.8, 1.25)


def _rows(label: str, estimates: Sequence[Sequence[Judged]]) -> list[Check]:
    rows = []
    for k, quantity in enumerate(QUANTITIES):
        ratios = ratios_of(estimates, k)
        inside = 100.0 * float((np.abs(ratios) < _TWO_SIDED_95).mean())
        rows += within(f"{label}, NEES per dof, {quantity}", float((ratios**2).mean()), 0.8, 1.25)
        rows += within(
            f"{label}, joint NEES per dof, {quantity}", float(nees_of(estimates, k).mean()), 0.8, 1.25
        )
        rows += within(f"{label}, 95 % intervals cover, {quantity}", inside, 90.0, 98.0, "%")
    return rows
