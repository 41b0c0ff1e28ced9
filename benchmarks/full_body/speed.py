"""Table 4.4 measured again: capture time over computing time, and what a frame costs in all, also in products P.

Every filter is driven as trials and live streams drive it, on one thread. The filters take turns trial by trial, with
a product P (168 × 168, as in ``benchmarks.speed``) between the frames; frame by frame the greatest of them would leave
cold caches to the others. Times are CPU time, the thesis's own measure, which other programs hardly move.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from time import thread_time

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.dynamic.methods import Method, tared
from benchmarks.full_body.filters import CAUSAL, DYNAMIC, FCDI, FDMC, FDMC_PRINTED
from benchmarks.speed.products import SIZE as PRODUCT_SIZE
from benchmarks.thesis_report.contents import OPEN, Band, Claim, Findings, Row, Sheet, judged
from benchmarks.thesis_report.figures import BLUE, GREEN, GREY, ORANGE, Drawing, axes, labelled, legend
from mbkf.conventions import Array
from mbkf.errors import NotObservable
from mbkf.filters.estimate import Posterior
from mbkf.filters.record import FrameRecorder
from mbkf.filters.tracking_loop import TrackingLoop
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.model.newton_euler import NewtonEuler
from mbkf.numerics.threads import single_threaded
from mbkf.trial.preparation.filters import tracking_filter
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.selection import subject_markers
from mbkf.trial.synth import synthesise

ROUNDS, QUICK_ROUNDS = 5, 1
"""The thesis, too, runs its capture five times."""

SECONDS, QUICK_SECONDS = 4.0, 1.0

FILTERS = (FCDI, FDMC_PRINTED, FDMC, DYNAMIC)
"""FDMC per frame differs from FDMC as printed in numbers only, and so costs the same."""

METHODS: Mapping[str, Method] = {name: CAUSAL[name] for name in FILTERS}

PARTS = ("step", "standard deviations", "NIS", "records")
STEP = PARTS[0]
PART_COLOURS = dict(zip(PARTS, (BLUE, ORANGE, GREEN, GREY), strict=True))


@dataclass(frozen=True)
class Printed:
    """Real-time factors of the thesis (Table 4.4, AMD Ryzen 7 3700X): in Matlab and in C generated from it."""

    matlab: float
    c: float


TABLE_4_4 = {FCDI: Printed(1.99, 3.29), FDMC_PRINTED: Printed(1.51, 2.41)}

_MS, _US = 1e3, 1e6


@dataclass(frozen=True)
class Timing:
    """What the frames of a trial cost a filter.

    Attributes:
        seconds: (rounds, T, parts) computing time by :data:`PARTS`; NaN in frames in which the filter starts or has
            lost the body.
        dt_s: Time between frames.
    """

    seconds: Array
    dt_s: float

    @property
    def parts_s(self) -> Array:
        """(parts,) of a frame: mean over frames of the rounds' median, which a disturbed round does not move."""
        whole = ~np.isnan(self.seconds).any(axis=(0, 2))
        parts: Array = np.median(self.seconds[:, whole], axis=0).mean(axis=0)
        return parts

    @property
    def step_s(self) -> float:
        """Of a frame's step alone."""
        return float(self.parts_s[PARTS.index(STEP)])

    @property
    def frame_s(self) -> float:
        """Of a frame, all parts."""
        return float(self.parts_s.sum())

    @property
    def real_time(self) -> float:
        """Capture time over computing time of the steps; computing time is the mean of all rounds, as in the thesis."""
        return float(self.dt_s / np.nanmean(self.seconds[:, :, PARTS.index(STEP)]))


@dataclass(frozen=True)
class Speed:
    """All measurements: the ``timings`` by filter, the median product P in seconds, and the number of ``rounds``."""

    timings: Mapping[str, Timing]
    product_s: float
    rounds: int


def measure_speed(quick: bool) -> Speed:
    """Follows a synthetic walk at 100 Hz with every filter.

    Args:
        quick: Whether one round of a shorter walk will do.
    """
    rounds = QUICK_ROUNDS if quick else ROUNDS
    with single_threaded():
        subject, made = synthesise("walk", seconds=QUICK_SECONDS if quick else SECONDS)
        return time_filters(subject, tared(made.trial), made.truth.foot_wrench, rounds)


def time_filters(
    subject: Subject,
    capture: Capture,
    foot_wrench: Array,
    rounds: int,
    methods: Mapping[str, Method] = METHODS,
) -> Speed:
    """Times filters on a capture, in turns.

    Args:
        subject: The person.
        capture: Markers and plates.
        foot_wrench: (T, 2, 6) wrenches for inverse dynamics after the kinematic filter.
        rounds: How often the capture is followed.
        methods: The filters by name.

    Raises:
        NotObservable: A filter does not follow a single frame.
    """
    products: list[float] = []
    factor = np.random.default_rng(0).normal(size=(PRODUCT_SIZE, PRODUCT_SIZE))
    drivers = {name: _Driver(one, subject, capture, foot_wrench) for name, one in methods.items()}
    frames = len(foot_wrench)
    seconds = {name: np.full((rounds, frames, len(PARTS)), np.nan) for name in methods}
    for k in range(rounds):
        for name, driver in drivers.items():
            driver.rewind()
            for t in range(frames):
                begin = thread_time()
                np.matmul(factor, factor)
                products.append(thread_time() - begin)
                seconds[name][k, t] = driver.frame(t)
    dt = 1.0 / capture.markers.rate_hz
    for name, found in seconds.items():
        if np.isnan(found).any(axis=(0, 2)).all():
            raise NotObservable(f"{name} follows no frame of the capture, so there is nothing to time")
    return Speed(
        {name: Timing(found, dt) for name, found in seconds.items()}, float(np.median(products)), rounds
    )


class _Driver:
    """A filter on its way through a capture, with all that is written down of a frame."""

    def __init__(self, method: Method, subject: Subject, capture: Capture, foot_wrench: Array) -> None:
        shown = subject_markers(capture.markers, subject)
        inputs, self._recording = trial_inputs(shown, capture.plates, subject, method.settings())
        self._filter = tracking_filter(method.filter, inputs)
        self._recorder = FrameRecorder(self._filter, len(shown.names))
        self._torques_are_states = method.filter == "torque"
        self._balance, self._foot_wrench = NewtonEuler(self._filter.model), foot_wrench
        self._loop = TrackingLoop(self._filter)

    def rewind(self) -> None:
        """Back to the beginning."""
        self._loop.forget()

    def frame(self, t: int) -> Array:
        """(parts,) seconds of frame t, the one after the last; NaN where the filter starts or has lost the body."""
        recorder, markers = self._recorder, self._recording.markers_m[t]
        ticks = [thread_time()]
        posterior = self._loop.advance(self._recording, t)
        if posterior is None:
            return np.full(len(PARTS), np.nan)
        if not self._torques_are_states:
            self._torques(posterior, t)
        ticks.append(thread_time())
        row, _ = recorder.row(t, markers, None, 0.0)
        recorder.step(row, posterior, 0.0)
        ticks.append(thread_time())
        recorder.spread(row, recorder.motion(row, posterior))
        ticks.append(thread_time())
        recorder.innovation(row, posterior)
        ticks.append(thread_time())
        if posterior.started or not posterior.tracked:
            return np.full(len(PARTS), np.nan)
        step, records, deviations, innovation = np.diff(ticks)
        return np.array([step, deviations, innovation, records])

    def _torques(self, posterior: Posterior, t: int) -> Array:
        wrench = posterior.wrench if np.isfinite(posterior.wrench).all() else self._foot_wrench[t]
        return self._balance.tau(posterior.q, posterior.v, posterior.a, wrench.ravel())


def speed_findings(speed: Speed) -> Findings:
    """Table 4.4 beside our times.

    Args:
        speed: What was measured.
    """
    timings = speed.timings
    dynamic = timings[DYNAMIC]
    ratio = dynamic.step_s / min(timings[FDMC_PRINTED].step_s, timings[FDMC].step_s)
    bands = [
        Band("computing time", "dynamic step over the faster FDMC's step", ratio, -OPEN, 1.0, "", False),
    ]
    return Findings(bands, [_table_4_4(speed)], [_claim(timings)])


def real_time_factors(speed: Speed) -> list[Check]:
    """Capture time over computing time of every filter, for information: it is the machine's as well."""
    return [
        information(f"capture time over computing time: {name}", one.real_time)
        for name, one in speed.timings.items()
    ]


def _table_4_4(speed: Speed) -> Sheet:
    times = tuple(f"{part} (ms)" for part in (*PARTS, "in all"))
    columns = ("filter", "real time / CPU", "thesis, Matlab", "thesis, C", *times, "step (P)", "in all (P)")
    note = (
        f"A synthetic walk at 100 Hz, CPU time on one thread, {speed.rounds} rounds in which the filters take turns; "
        "of a frame the median of the rounds, then the mean over the frames that a filter follows. P = "
        f"{_US * speed.product_s:.0f} µs is a product of two 168 × 168 matrices, measured between the frames. A step "
        "ends with the joint torques, and the real-time factor is of it alone: by inverse dynamics in FCDI and after "
        "the dynamic filter; FDMC has them as states, and its step already works out their standard deviations and "
        "the NIS. Standard deviations are those of motion, torques, wrenches, clinical angles with their rates, and "
        "the height of the feet, written into the record; records are its other fields. FDMC per frame does what FDMC "
        "as printed does, with other numbers. The thesis ran on an AMD Ryzen 7 3700X: its ratios compare, not its "
        "factors."
    )
    rows = tuple(_row(name, one, speed.product_s) for name, one in speed.timings.items())
    return Sheet(
        "table_4_4",
        "Table 4.4: capture time over computing time, and what a frame costs",
        columns,
        rows,
        note,
    )


def _row(name: str, one: Timing, product_s: float) -> Row:
    printed = TABLE_4_4.get(name)
    theirs: Row = ("–", "–") if printed is None else (printed.matlab, printed.c)
    times = [_MS * float(part) for part in one.parts_s]
    return (
        name, one.real_time, *theirs, *times, _MS * one.frame_s, one.step_s / product_s, one.frame_s / product_s
    )  # fmt: skip


def _claim(timings: Mapping[str, Timing]) -> Claim:
    kinematic = timings[FCDI].real_time
    others = {name: one.real_time for name, one in timings.items() if name != FCDI}
    theirs = TABLE_4_4[FCDI].c / TABLE_4_4[FDMC_PRINTED].c
    times = "; ".join(
        f"{name} {factor:.1f} times real time, FCDI {kinematic / factor:.1f} times as fast"
        for name, factor in others.items()
    )
    return Claim(
        "Table 4.4",
        "Both filters run faster than real time, the kinematic one with inverse dynamics faster than the dynamic one.",
        f"FCDI {kinematic:.1f} times real time; {times} (thesis {theirs:.2f} in C)",
        judged(
            min(kinematic, *others.values()) > 1.0 and kinematic > max(others.values()),
            kinematic > 1.0 and others[FDMC_PRINTED] > 1.0,
        ),
    )


def speed_drawing(speed: Speed) -> Drawing:
    """The time of a frame by part, one bar per filter."""
    figure, (one,) = axes(height=2.4)
    names = list(speed.timings)
    left = np.zeros(len(names))
    for k, part in enumerate(PARTS):
        width = np.array([_MS * timing.parts_s[k] for timing in speed.timings.values()])
        one.barh(names, width, left=left, height=0.6, color=PART_COLOURS[part], label=part)
        left += width
    for place, whole in enumerate(left):
        one.text(whole, place, f" {whole:.2f} ms", va="center", fontsize=8)
    one.set_axisbelow(True)
    one.margins(x=0.12)
    one.invert_yaxis()
    labelled(one, "computing time of a frame (ms)", "")
    legend(one)
    product = f"a product of two 168 × 168 matrices, takes {_MS * speed.product_s:.2f} ms"
    note = f"At 100 Hz there are 10 ms for a frame. P, {product}."
    return Drawing("own", "What a frame costs by part", figure, note)
