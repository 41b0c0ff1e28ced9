"""Time of one frame, as a multiple of P: a dense 168 × 168 numpy product on one thread, measured between the frames.

A synthetic walk is followed with the default settings, so no reference captures are needed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from benchmarks.checks import Check, Context
from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.errors import InvalidInput
from mbkf.filters.dynamic.filter import DynamicFilter
from mbkf.filters.dynamic.settings import DynamicSettings
from mbkf.filters.kinematic.filter import KinematicFilter
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.model.newton_euler import NewtonEuler
from mbkf.numerics.threads import single_threaded
from mbkf.pipelines.reconstruct import subject_markers
from mbkf.pipelines.synth import synthesise
from mbkf.sensors.block import Frame
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.contact.plates import plate_wrenches
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.synthesis.person import body_of

PRODUCT_SIZE = 168
SECONDS, QUICK_SECONDS = 4.0, 1.0
WARM_UP_FRAMES = 10
LEAST_STEPS = 1200
"""A 99th percentile needs as many; the walk is followed again until there are. Garbage is collected as it falls."""

INFORMATION = math.inf
"""The bound of a number that has none."""


@dataclass(frozen=True)
class Walk:
    """A walk to follow: filters, Newton–Euler equations, markers (T, M, 3), wrenches (2, 6) in the place of plates.

    ``plates`` (T, K, 6) are what the dynamic filter reads.
    """

    kalman: KinematicFilter
    dynamic: DynamicFilter
    plates: Array
    balance: NewtonEuler
    measured_m: Array
    foot_wrench: Array


@dataclass(frozen=True)
class Times:
    """Seconds per frame (T,): the ``product`` P, the ``parts`` of the frame by name."""

    product: Array
    parts: dict[str, Array]

    def in_products(self, *names: str, percentile: float = 50.0) -> float:
        """Percentile over frames of the named parts' sum, as a multiple of the median P."""
        frame = np.sum([self.parts[name] for name in names], axis=0)
        return float(np.percentile(frame, percentile) / np.median(self.product))


def run(context: Context) -> list[Check]:
    """The kinematic filter with inverse dynamics behind it, and the dynamic filter, frame by frame."""
    walk = make_walk(QUICK_SECONDS if context.quick else SECONDS)
    times = time_kinematic(walk)
    dynamic = time_dynamic(walk, 1 if context.quick else math.ceil(LEAST_STEPS / len(walk.measured_m)))
    return [
        Check(
            "kinematic + inverse dynamics step, median",
            times.in_products("filter", "inverse dynamics"),
            1.0,
            "<=",
            "P",
        ),
        Check("of these the filter, median", times.in_products("filter"), INFORMATION, "<=", "P"),
        Check(
            "of these inverse dynamics, median", times.in_products("inverse dynamics"), INFORMATION, "<=", "P"
        ),
        Check("dynamic step, median", dynamic.in_products("filter"), 2.0, "<=", "P"),
        Check(
            "dynamic step, 99th percentile", dynamic.in_products("filter", percentile=99.0), 6.0, "<=", "P"
        ),
        Check("P, median", 1e6 * float(np.median(times.product)), INFORMATION, "<=", "µs"),
    ]


def make_walk(seconds: float) -> Walk:
    """A random person's walk, with each foot carrying half of the weight."""
    subject, capture = synthesise("walk", seconds=seconds)
    measured = subject_markers(capture.trial.markers, subject)
    model = body_of(subject)
    followed = [marker for name in measured.names for marker in subject.markers if marker.name == name]
    sensor = MarkerSensor(model, [m.segment for m in followed], np.array([m.position_m for m in followed]))
    noise = np.array([marker.noise_m for marker in followed])
    unobservable = np.zeros(model.nv, dtype=bool)
    kalman = KinematicFilter(sensor, noise, 1.0 / measured.rate_hz, unobservable, KinematicSettings())
    wrench = np.zeros((2, 6))
    wrench[:, 2] = 0.5 * model.mass_kg * GRAVITY_M_S2
    plates = capture.trial.plates
    loads = plate_wrenches(plates, measured.times_s, measured.rate_hz)
    feet = ContactDetector(model, plates, kalman.plant.dt_s)
    dynamic = DynamicFilter.standard(sensor, noise, feet, kalman.plant.dt_s, unobservable, DynamicSettings())
    return Walk(kalman, dynamic, loads, NewtonEuler(model), measured.positions_m, wrench)


def time_kinematic(walk: Walk) -> Times:
    """Follows the walk frame by frame and times filter, inverse dynamics and P in turn."""
    kalman, dt = walk.kalman, walk.kalman.plant.dt_s
    factor = np.random.default_rng(0).normal(size=(PRODUCT_SIZE, PRODUCT_SIZE))
    rows = []
    with single_threaded():
        state = kalman.start(walk.measured_m[0])
        if state is None:
            raise InvalidInput("the synthetic walk does not start")
        memory, no_plates = kalman.begin(), np.zeros((0, 6))
        for markers in walk.measured_m[1:]:
            ticks = [perf_counter()]
            np.matmul(factor, factor)
            ticks.append(perf_counter())
            done = kalman.step(state, memory, Frame(markers, no_plates))
            result, memory = done.state, done.memory
            ticks.append(perf_counter())
            walk.balance.tau(result.q, result.v, (result.v - state.v) / dt, walk.foot_wrench.ravel())
            ticks.append(perf_counter())
            state = result
            rows.append(np.diff(ticks))
    product, filtering, solving = np.array(rows)[WARM_UP_FRAMES:].T
    return Times(product, {"filter": filtering, "inverse dynamics": solving})


def time_dynamic(walk: Walk, rounds: int) -> Times:
    """Follows the walk so many times and times the dynamic filter and P in turn."""
    kalman = walk.dynamic
    factor = np.random.default_rng(0).normal(size=(PRODUCT_SIZE, PRODUCT_SIZE))
    rows = []
    with single_threaded():
        start = walk.kalman.start(walk.measured_m[0])
        if start is None:
            raise InvalidInput("the synthetic walk does not start")
        still = np.zeros(kalman.model.nv)
        for _ in range(rounds):
            done = kalman.first(start.q, start.v, still, start.P, Frame(walk.measured_m[0], walk.plates[0]))
            for markers, plates in zip(walk.measured_m[1:], walk.plates[1:], strict=True):
                ticks = [perf_counter()]
                np.matmul(factor, factor)
                ticks.append(perf_counter())
                done = kalman.step(done.state, done.memory, Frame(markers, plates))
                ticks.append(perf_counter())
                rows.append(np.diff(ticks))
    product, filtering = np.array(rows)[WARM_UP_FRAMES:].T
    return Times(product, {"filter": filtering})
