"""The dynamic filter, causal and smoothed: residuals, torques, consistency, lost markers and lost plates.

One row per bound. Real captures are scaled and reconstructed with default settings; synthetic ones have known truth.
Where FCDI is named, it is the kinematic filter followed by inverse dynamics, at the factor on its accelerations that
suits it best for that row. Runs in-process on two workers; the same numbers come out every time.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

from benchmarks.checks import Check, Context
from benchmarks.dynamic.captures import SOURCES, all_capture_rows
from benchmarks.dynamic.consistency import own_plant_rows
from benchmarks.dynamic.losses import (
    CAPTURES,
    FRACTIONS,
    LOSS_MOTIONS,
    LOSS_NOISE,
    loss_rows,
    occlusion_rows,
)
from benchmarks.dynamic.methods import SCALES, Mapper, Method, dynamic_pair, in_parallel
from benchmarks.dynamic.synthetic import MOTIONS, accuracy_rows, cases
from benchmarks.dynamic.synthetic_consistency import consistency_rows
from mbkf.errors import MbkfError

SEEDS, QUICK_SEEDS = 20, 2
OCCLUSION_SEEDS, QUICK_OCCLUSION_SEEDS = 10, 2
LOSS_SEEDS = 6
CONSISTENCY_SEEDS = 3
QUICK_SCALES = (0.04, 0.15, 0.6)

Rows = Callable[[], list[Check]]


def run(context: Context) -> list[Check]:
    """Every row of the table; rajagopal walk and two synthetic seeds when quick."""
    data = context.require_data()
    with in_parallel() as mapper:
        return run_with(data, dynamic_pair(), mapper, quick=context.quick)


def run_with(data: Path, methods: Sequence[Method], mapper: Mapper, *, quick: bool) -> list[Check]:
    """The rows of any methods; one that does not run fails its own rows only.

    Args:
        data: Folder of the reference captures.
        methods: Filters with their settings.
        mapper: Runs a function on many items, in turn or on several processes.
        quick: Whether to do a shorter run.
    """
    checks: list[Check] = []
    for name, rows in parts(data, methods, mapper, quick=quick):
        try:
            checks += rows()
        except MbkfError as error:
            checks.append(Check(f"{name} does not run: {error}", float("nan"), 0.0, "<="))
    return checks


def parts(
    data: Path, methods: Sequence[Method], mapper: Mapper, *, quick: bool
) -> Iterator[tuple[str, Rows]]:
    """The parts of the table by name, each computed when it is called.

    Args:
        data: Folder of the reference captures.
        methods: Filters with their settings.
        mapper: Runs a function on many items, in turn or on several processes.
        quick: Whether to do a shorter run.
    """
    names = ("rajagopal walk",) if quick else tuple(SOURCES)
    yield "real captures", partial(all_capture_rows, names, data, methods, mapper)
    for name in names if quick else CAPTURES:
        for fraction in FRACTIONS:
            seeds = range(QUICK_OCCLUSION_SEEDS if quick else OCCLUSION_SEEDS)
            occluded = partial(occlusion_rows, name, fraction, data, methods, mapper, seeds=seeds)
            yield f"occlusion of {name}", partial(occluded, scales=QUICK_SCALES) if quick else occluded
    for motion in ("squat",) if quick else MOTIONS:
        yield f"synthetic {motion}", partial(synthetic_rows, motion, methods, mapper, quick)
    for motion in () if quick else LOSS_MOTIONS:
        yield f"a leg lost in the {motion}", partial(leg_rows, motion, methods, mapper)
    seeds = range(1 if quick else CONSISTENCY_SEEDS)
    keys = [(motion, seed) for motion in (("squat",) if quick else MOTIONS) for seed in seeds]
    yield "matched noise", partial(own_plant_rows, mapper, quick=quick)
    yield "camera noise only", partial(consistency_rows, keys, methods, mapper)


def synthetic_rows(motion: str, methods: Sequence[Method], mapper: Mapper, quick: bool) -> list[Check]:
    """Accuracy on one motion's trials.

    Args:
        motion: Name of a synthetic motion.
        methods: Filters with their settings.
        mapper: Runs a function on many items, in turn or on several processes.
        quick: Whether to do a shorter run.
    """
    trials = cases([motion], range(QUICK_SEEDS if quick else SEEDS), mapper)
    return accuracy_rows(trials, methods, mapper, scales=QUICK_SCALES if quick else SCALES)


def leg_rows(motion: str, methods: Sequence[Method], mapper: Mapper) -> list[Check]:
    """A leg's markers lost in one motion's trials.

    Args:
        motion: Name of a synthetic motion.
        methods: Filters with their settings.
        mapper: Runs a function on many items, in turn or on several processes.
    """
    return loss_rows(cases([motion], range(LOSS_SEEDS), mapper, LOSS_NOISE), methods, mapper)
