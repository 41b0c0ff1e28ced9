"""What labels add to the time of a filter's step, in P, for 36 markers among 50 points."""

from __future__ import annotations

import math
from collections.abc import Sequence
from time import perf_counter

import numpy as np

from benchmarks.checks import Check
from benchmarks.speed.products import SIZE as PRODUCT_SIZE
from mbkf.conventions import Array
from mbkf.filters.estimate import Posterior, Recording
from mbkf.filters.kinematic.filter import KinematicFilter
from mbkf.filters.kinematic.report import KinematicReport
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.kinematic.warm_start import WarmStart
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.labelling.running import RunningLabeller
from mbkf.model.human import HumanModel
from mbkf.numerics.threads import single_threaded
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.trial.synth import synthesise

MARKERS, POINTS = 36, 50
PARTS = ("prediction", "assignment", "correction", "memory")
WARM_UP_FRAMES = 20


class TimedWalk:
    """A walk followed and labelled frame by frame, with a filter that is given the true labels."""

    def __init__(self) -> None:
        person, made = synthesise("walk")
        model = HumanModel.of(person)
        segments, places = [m.segment for m in person.markers], [m.position_m for m in person.markers]
        noise = np.array([m.noise_m for m in person.markers])
        self.sensor = MarkerSensor(model, segments, np.array(places))
        self.markers = made.trial.markers
        dt = 1.0 / self.markers.rate_hz
        nowhere = np.zeros(model.nv, dtype=bool)
        kalman = KinematicFilter(self.sensor, noise, dt, nowhere, KinematicSettings())
        self.tracking = TrackingFilter(KinematicReport(kalman), WarmStart(kalman))
        self.recording = Recording(self.markers.positions_m, np.zeros((self.markers.frames, 0, 6)), dt)
        self.labeller = RunningLabeller(noise, np.full(len(noise), 0.005), dt)

    def points_m(self, t: int, rng: np.random.Generator) -> Array:
        """(50, 3) a frame's markers and ghosts about them, shuffled."""
        shown = self.markers.positions_m[t]
        shown = shown[~np.isnan(shown).any(axis=1)]
        extra = shown.mean(axis=0) + rng.uniform(-0.8, 0.8, (POINTS - len(shown), 3))
        return rng.permutation(np.concatenate([shown, extra]))

    def plain(self, before: Posterior, t: int) -> list[float]:
        """Seconds of the filter's step without labels."""
        begin = perf_counter()
        self.tracking.step(before, self.recording, t)
        return [perf_counter() - begin]

    def labelled(self, before: Posterior, t: int, points: Array) -> tuple[Posterior, Array]:
        """The step with labels between prediction and correction, and the time (4,) of its parts, s.

        Args:
            before: Estimate of the frame before.
            t: The frame.
            points: (N, 3) its points, m.
        """
        ticks = [perf_counter()]
        prediction = self.tracking.predict(before)
        ticks.append(perf_counter())
        labels = self.labeller.label(prediction.markers, points)
        ticks.append(perf_counter())
        estimate = self.tracking.step(before, self.recording, t, prediction)
        ticks.append(perf_counter())
        on_body = self.sensor.positions(estimate.q) if self.labeller.learns else points[:0]
        self.labeller.remember(labels, points, on_body)
        ticks.append(perf_counter())
        return estimate, np.diff(ticks)


def speed_rows() -> list[Check]:
    """Each frame is stepped with and without labels, in turns, each time after a product P and a step for nothing."""
    walk, rng = TimedWalk(), np.random.default_rng(1)
    factor = rng.normal(size=(PRODUCT_SIZE, PRODUCT_SIZE))
    rows: list[Array] = []
    with single_threaded():
        estimate = walk.tracking.start(walk.recording, 0, None)
        assert estimate is not None, "the synthetic walk starts"
        for t in range(1, walk.markers.frames):
            points, after = walk.points_m(t, rng), estimate
            seconds: dict[str, Sequence[float] | Array] = {}
            for kind in ("warm", "plain", "labelled") if t % 2 else ("warm", "labelled", "plain"):
                begin = perf_counter()
                np.matmul(factor, factor)
                seconds["P"] = [perf_counter() - begin]
                if kind == "labelled":
                    after, seconds[kind] = walk.labelled(estimate, t, points)
                else:
                    seconds[kind] = walk.plain(estimate, t)
            estimate = after
            rows.append(np.concatenate([seconds[kind] for kind in ("P", "plain", "labelled")]))
    product, plain, *parts = np.array(rows[WARM_UP_FRAMES:]).T
    added = np.sum(parts, axis=0) - plain
    unit, name = float(np.median(product)), f"labels of {MARKERS} markers among {POINTS} points"
    shares = {"filter alone": plain, **dict(zip(PARTS, parts, strict=True))}
    return [
        Check(f"{name}, added to the filter's step, median", float(np.median(added)) / unit, 0.15, "<=", "P"),
        Check(f"{name}, added, mean", float(added.mean()) / unit, math.inf, "<=", "P"),
        *(
            Check(f"{name}: {part}, median", float(np.median(s)) / unit, math.inf, "<=", "P")
            for part, s in shares.items()
        ),
    ]
