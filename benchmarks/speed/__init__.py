"""Time of a frame, as a multiple of P, and of whole commands; how it grows with markers and plates.

Times of frames are ratios within one run to a product of matrices that is measured between the frames
(``products.py``). The synthetic walk needs no reference captures; the real one is left out without them. The benchmark
``labelling`` measures the cost of labels, ``live`` the frames a second that a stream may have.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from benchmarks.checks import Check, Context, information
from benchmarks.parts import Part, part_rows
from benchmarks.speed import batch_time, bodies, commands, growth, offline, processor_time, start
from benchmarks.speed.products import Times
from benchmarks.speed.steps import (
    INVERSE_DYNAMICS,
    LEAST_STEPS,
    NIS,
    RECORD,
    SPREADS,
    STEP,
    dynamic_times,
    kinematic_times,
)
from benchmarks.speed.walks import REAL, Walk, real, synthetic

SECONDS, QUICK_SECONDS = 4.0, 1.0
QUICK_STEPS = 80
STEP_P, TAIL, FRAME_P, KINEMATIC_P = 1.5, 1.5, 3.0, 0.6


def run(context: Context) -> list[Check]:
    """Rows of all parts, or of those of ``--only``; time of a frame alone when quick."""
    if context.quick and not context.only:
        context = replace(context, only=("frames",))
    return part_rows(context, PARTS)


def frame_rows(context: Context) -> Iterator[Check]:
    """Time of a frame; the synthetic walk's alone, and fewer steps, when quick."""
    seconds, steps = (QUICK_SECONDS, QUICK_STEPS) if context.quick else (SECONDS, LEAST_STEPS)
    walks: dict[str, Walk] = {"synthetic walk": synthetic(seconds)}
    if context.data is not None and not context.quick:
        walks[REAL] = real(context.data)
    for name, walk in walks.items():
        yield from _dynamic(name, dynamic_times(walk, steps))
        yield from _kinematic(name, kinematic_times(walk, steps))


PARTS: dict[str, Part] = {
    "frames": frame_rows,
    "growth": lambda _: growth.rows(SECONDS, LEAST_STEPS // 4),
    "bodies": lambda context: bodies.rows(context.data),
    "commands": lambda context: commands.rows(context.out),
    "batch": lambda context: batch_time.rows(context.out, *((1, 2) if context.quick else ())),
    "start": lambda context: start.rows(context.out),
    "processor": processor_time.rows,
    "offline": lambda context: offline.rows(context.out, context.minutes),
}


def _dynamic(name: str, times: Times) -> list[Check]:
    step = times.in_products(STEP)
    return [
        Check(f"{name}: dynamic step", step, STEP_P, "<=", "P"),
        Check(
            f"{name}: its 99th percentile over it",
            times.in_products(STEP, percentile=99.0) / step,
            TAIL,
            "<=",
        ),
        Check(f"{name}: all that a frame costs", times.in_products(*times.parts), FRAME_P, "<=", "P"),
        *(
            information(f"{name}: of these {part}", times.in_products(part), "P")
            for part in (SPREADS, NIS, RECORD)
        ),
        information(f"{name}: P", 1e6 * float(sorted(times.product)[len(times.product) // 2]), "µs"),
    ]


def _kinematic(name: str, times: Times) -> list[Check]:
    return [
        Check(
            f"{name}: kinematic step and inverse dynamics",
            times.in_products(*times.parts),
            KINEMATIC_P,
            "<=",
            "P",
        ),
        information(f"{name}: of these inverse dynamics", times.in_products(INVERSE_DYNAMICS), "P"),
    ]
