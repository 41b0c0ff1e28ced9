"""The torque filters FD and FDMC against the clock, live, and by the compiled kernel against the reference.

The thesis introduces FDMC so that torques are estimated in real time (Table 4.4, 2.41 times in C), and its simplified F
because it saves time (Table A.3, 1.18 times). Times are CPU time of a frame's step on one thread, a synthetic walk with
36 markers and two plates at 100 Hz; the filters take turns, so that their ratio is one run's.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from benchmarks.checks import Check, Context, information, number
from benchmarks.dynamic.methods import Method, tared
from benchmarks.equality.compare import BOUND
from benchmarks.full_body.speed import Speed, time_filters
from benchmarks.kernel import apart
from benchmarks.live import latency, lost, synthetic
from benchmarks.live.runs import play
from mbkf.filters.torque.settings import TorqueSettings, preset
from mbkf.numerics.threads import single_threaded
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.synth import synthesise

REAL_TIME = {"FDMC": 10.0, "FD": 6.0}
"""Least capture time over computing time."""

COMPLETE = "FDMC, complete F"
SIMPLIFIED = 0.85
"""Greatest time of a step with the simplified F over one with the complete F, that of thesis Table A.3."""

BOTH_ROUND = 2.0
"""Greatest difference of kernel and reference over the last digit's effect on the reference: where neither rounds by
more than that effect, they differ by no more than twice as much."""

LATENCY_MS = 8.0
SECONDS, QUICK_SECONDS = 4.0, 1.0
ROUNDS, QUICK_ROUNDS = 5, 2
LIVE_SECONDS, QUICK_LIVE_SECONDS = 20.0, 5.0
MOTIONS, QUICK_MOTIONS = ("squat", "walk", "jump"), ("squat",)
_MS = 1e3


def methods() -> dict[str, Method]:
    """FDMC, FD, and FDMC with the complete F."""
    light, exact = preset("FDMC"), preset("FD")
    complete = replace(light, scheme=replace(light.scheme, complete=True))
    return {name: _method(one) for name, one in (("FDMC", light), ("FD", exact), (COMPLETE, complete))}


def _method(settings: TorqueSettings) -> Method:
    return Method("torque", extra={"torque": settings})


def run(context: Context) -> list[Check]:
    """All rows; a shorter walk when quick."""
    quick = context.quick
    with single_threaded():
        subject, made = synthesise("walk", seconds=QUICK_SECONDS if quick else SECONDS)
        speed = time_filters(
            subject, tared(made.trial), made.truth.foot_wrench, QUICK_ROUNDS if quick else ROUNDS, methods()
        )
    return [
        *speed_rows(speed),
        *live_rows(context.out, QUICK_LIVE_SECONDS if quick else LIVE_SECONDS),
        *equality_rows(QUICK_MOTIONS if quick else MOTIONS),
    ]


def speed_rows(speed: Speed) -> list[Check]:
    """Real-time factors, and the simplified over the complete F.

    Args:
        speed: Times of :func:`methods`.
    """
    timings = speed.timings
    return [
        *(
            Check(f"{name}: capture time over computing time", timings[name].real_time, least, ">=")
            for name, least in REAL_TIME.items()
        ),
        Check(
            "simplified over complete F, time of a step",
            timings["FDMC"].step_s / timings[COMPLETE].step_s,
            SIMPLIFIED,
            "<=",
        ),
        *(information(f"{name}: a step", _MS * one.step_s, "ms") for name, one in timings.items()),
        information("a product of two 168 × 168 matrices meanwhile", _MS * speed.product_s, "ms"),
    ]


def live_rows(out: Path, seconds: float) -> list[Check]:
    """`mbkf live --filter torque --preset FDMC` on a walk at 100 Hz that is played through LSL.

    Args:
        out: Folder for files.
        seconds: Length of the walk.
    """
    trial = synthetic(out, seconds, 100.0)
    found = play(trial, "lsl", out / "run", filter_words=("torque", "--preset", "FDMC"))
    name = "FDMC live, 100 Hz, LSL"
    waited = number(found.report["frames_at_start"])
    return [
        lost(name, found),
        *(one for one in latency(name, found, LATENCY_MS) if not one.name.endswith("beyond that")),
        information(f"{name}: frames that waited for the start", waited),
    ]


def equality_rows(motions: tuple[str, ...]) -> list[Check]:
    """The compiled kernel against the reference: the largest difference of any array of results.

    The pelvis residual and the change of the plates that the filter wants are small differences of large forces: they
    change by up to five times the bound when the input of the reference moves by the last digit, and are not stable.

    Args:
        motions: Synthetic motions, one person each.
    """
    found = {
        f"{name}, {motion}": apart(motion, 0, _settings(name)) for name in REAL_TIME for motion in motions
    }
    share = "share of each array's largest value, where the reference is stable"
    return [
        *(
            Check(f"{name}: kernel against reference, {share}", one.stable, BOUND, "<=")
            for name, one in found.items()
        ),
        *(
            Check(
                f"{name}: over the last digit's effect on the reference", one.over_rounding, BOTH_ROUND, "<="
            )
            for name, one in found.items()
        ),
    ]


def _settings(name: str) -> ReconstructSettings:
    return ReconstructSettings(filter="torque", torque=preset(name), smooth=False, checks=False)
