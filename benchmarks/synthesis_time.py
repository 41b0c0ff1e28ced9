"""Time of `mbkf synth`: the processor's time per frame of a walk as a multiple of P, and how it grows with the walk.

P is a product of matrices measured in the same run (``speed/products.py``).
"""

from __future__ import annotations

from pathlib import Path
from time import process_time

import numpy as np

from benchmarks.checks import Check, Context
from benchmarks.speed.products import product_seconds
from mbkf.trial.synth import synthesise, write_folder

SECONDS, QUICK_SECONDS = (15.0, 60.0), (1.0, 4.0)
RATE_HZ = 100.0
PRODUCTS = 200

FRAME_P, GROWTH = 20.0, 1.2
"""Bounds: time per frame of the long walk, P, and that over the short walk's."""


def run(context: Context) -> list[Check]:
    """Both rows; of short walks when quick."""
    write_walk(1.0, context.out)  # what is imported or read once stays out of the times
    short, long = QUICK_SECONDS if context.quick else SECONDS
    first, second = (per_frame(seconds, context.out) for seconds in (short, long))
    return [
        Check(f"walk of {long:g} s: time per frame", second, FRAME_P, "<=", "P"),
        Check(f"time per frame of {long:g} s over {short:g} s", second / first, GROWTH, "<="),
    ]


def per_frame(seconds: float, folder: Path) -> float:
    """Time per frame of a walk, with its files, as a multiple of the median P before and after.

    Args:
        seconds: Length of the walk.
        folder: Where its files go.
    """
    products = [product_seconds() for _ in range(PRODUCTS)]
    begin = process_time()
    write_walk(seconds, folder)
    took = process_time() - begin
    products += [product_seconds() for _ in range(PRODUCTS)]
    return float(took / (seconds * RATE_HZ) / np.median(products))


def write_walk(seconds: float, folder: Path) -> None:
    """What `mbkf synth --motion walk` does, into a folder."""
    write_folder(*synthesise("walk", seconds=seconds, rate_hz=RATE_HZ), folder / "walk")
