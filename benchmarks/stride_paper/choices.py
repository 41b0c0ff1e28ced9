"""The paper's choices: size and rate of windows, threshold, weights, and which side of the threshold is rest."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.inertial.cubic_steps import CASES, CubicSteps, cubic_steps
from benchmarks.stride_paper import printed
from benchmarks.stride_paper.errors import key_points, signed_errors
from benchmarks.stride_paper.printed import ALIGNED, AS_STUDIED
from benchmarks.thesis_report.contents import OPEN, Band, Claim, Findings, Row, Sheet, redone
from mbkf.conventions import Array
from mbkf.imu.key_points import NOISY_WEIGHTS, USUAL_WEIGHTS, KeyPointSettings, stability

WINDOW_SIZES = (5, 10, 20)
FINER = ((50.0, 10), (100.0, 10), (200.0, 10), (100.0, 20), (200.0, 40))
"""Rates, and samples per window: the paper's number of samples, and its time of a window."""

SEEDS = 3


@dataclass(frozen=True)
class Separation:
    """Stability of windows at one phase, over all cases and seeds.

    Attributes:
        first: First sample of the first window.
        resting: Largest S of a window that rests after a window that rests.
        moving: Least S of a window that moves for half of its time or more.
    """

    first: int
    resting: float
    moving: float


def choice_findings(seeds: int) -> Findings:
    """Bounds, tables and claims.

    Args:
        seeds: Of the noise.
    """
    separations = [_separation(first, seeds) for first in range(printed.WINDOW)]
    weights = _weights(seeds)
    sizes = {(50.0, size): _errors(50.0, size) for size in WINDOW_SIZES}
    rates = {one: _errors(*one) for one in FINER}
    reverse = _reverse()
    aligned = separations[ALIGNED]
    bands = [
        Band("key points", "least S of motion, aligned windows", aligned.moving, KeyPointSettings().threshold, OPEN, "",
             False),
        Band("key points", "largest S of rest, aligned windows", aligned.resting, -OPEN, KeyPointSettings().threshold,
             "", False),
    ]  # fmt: skip
    claims = [
        _count_claim(),
        _threshold_claim(separations),
        _reverse_claim(reverse),
        _weights_claim(weights),
        _size_claim(sizes),
        _rate_claim(rates),
    ]
    return Findings(bands, [_separation_sheet(separations), _size_sheet({**sizes, **rates})], claims)


def motion(walk: CubicSteps, settings: KeyPointSettings) -> Array:
    """(K,) share of each window's samples in which the walk moves."""
    K = (len(walk.time_s) - settings.first) // settings.window
    moving = np.gradient(walk.position_m[:, 0]) > 1e-12
    used = moving[settings.first : settings.first + K * settings.window].reshape(K, settings.window)
    share: Array = used.mean(axis=1)
    return share


def _walks(seeds: int) -> Iterator[tuple[str, CubicSteps]]:
    for case in CASES:
        for seed in range(seeds):
            yield case, cubic_steps(case, seed)


def _separation(first: int, seeds: int) -> Separation:
    resting, moving = [], []
    for case, walk in _walks(seeds):
        settings = printed.simulated(case, first)
        S, share = key_points(walk, settings).stability, motion(walk, settings)
        still = share == 0.0
        after_rest = still & np.concatenate([[True], still[:-1]])
        resting.append(S[after_rest].max())
        moving.append(S[share >= 0.5].min())
    return Separation(first, float(max(resting)), float(min(moving)))


def _weights(seeds: int) -> dict[str, tuple[float, float]]:
    """Share of motion held for rest with noise and drift, by the usual weights and by those for noise and drift."""
    phases = {"aligned": (ALIGNED,), "the paper's": (AS_STUDIED,), "ten phases": tuple(range(printed.WINDOW))}
    shares = {}
    for name, chosen in phases.items():
        held = np.zeros(2)
        for seed in range(seeds):
            walk = cubic_steps(printed.BOTH, seed)
            for first in chosen:
                settings = printed.simulated(printed.BOTH, first)
                moves = motion(walk, settings) >= 0.5
                keys = [
                    key_points(walk, replace(settings, weights=one)).still
                    for one in (USUAL_WEIGHTS, NOISY_WEIGHTS)
                ]
                held += [(key & moves).sum() / moves.sum() for key in keys]
        usual, noisy = held / (seeds * len(chosen))
        shares[name] = float(usual), float(noisy)
    return shares


def _errors(rate_hz: float, size: int) -> Array:
    """(n, 3) final and mean error as printed, and share of motion held for rest, over phases, cases and seeds."""
    found = []
    for case in CASES:
        for seed in range(SEEDS):
            walk = cubic_steps(case, seed, rate_hz=rate_hz)
            for first in range(0, size, max(1, size // 10)):
                settings = replace(printed.simulated(case, first), rate_hz=rate_hz, window=size)
                off = np.abs(signed_errors(walk, settings))
                key, moves = key_points(walk, settings).still, motion(walk, settings) >= 0.5
                found.append([off[-1], off.mean(), (key & moves).sum() / moves.sum()])
    return np.array(found)


def _reverse() -> tuple[float, float]:
    """Final and mean error of the clean case where S above the threshold is rest, as the paper's prose has it."""
    settings = printed.simulated("clean", ALIGNED)

    def mirrored(force: Array, rates: Array, weights: tuple[float, float, float]) -> Array:
        return 2.0 * settings.threshold - stability(force, rates, weights)

    off = np.abs(signed_errors(cubic_steps(), settings, mirrored))
    return float(off[-1]), float(off.mean())


def _separation_sheet(found: Sequence[Separation]) -> Sheet:
    rows: tuple[Row, ...] = tuple((float(one.first), one.resting, one.moving) for one in found)
    note = (
        "All cases and seeds, the paper's weights. E_s has to lie between the two. The window after a step is left "
        "out: the change of its mean makes it unstable."
    )
    return Sheet(
        "threshold", "Stability of rest and motion by the phase of the windows",
        ("first sample of the first window", "largest S at rest", "least S in motion"), rows, note,
    )  # fmt: skip


def _size_sheet(found: dict[tuple[float, int], Array]) -> Sheet:
    rows: tuple[Row, ...] = tuple(
        (
            f"{rate:g} Hz",
            f"{size} samples, {size / rate:g} s",
            float(np.median(errors[:, 0])),
            float(np.median(errors[:, 1])),
            float(errors[:, 0].max()),
            100.0 * float(errors[:, 2].mean()),
        )
        for (rate, size), errors in found.items()
    )
    columns = (
        "rate", "window", "median final m", "median mean m", "largest final m", "motion held for rest %",
    )  # fmt: skip
    return Sheet(
        "windows", "Size and rate of windows, as printed", columns, rows, "Over ten phases, cases and seeds."
    )


def _count_claim() -> Claim:
    walk = cubic_steps()
    count = len(key_points(walk, printed.simulated("clean")).time_s)
    measured = (
        f"{count} windows of {printed.WINDOW} in the second differences of {len(walk.time_s)} positions."
    )
    statement = f"{printed.SAMPLES} samples give {printed.WINDOWS} windows."
    return Claim("Method", statement, measured, redone(count == printed.WINDOWS))


def _threshold_claim(found: Sequence[Separation]) -> Claim:
    E = KeyPointSettings().threshold
    works = [one.first for one in found if one.resting < E < one.moving]
    low, high = found[AS_STUDIED].resting, found[AS_STUDIED].moving
    measured = (
        f"With the paper's windows every E_s from {low:.2f} to {high:.2f} gives the same key points in all four "
        f"cases. E_s = 1 does so in {len(works)} of {len(found)} phases of the windows; in the others a window full "
        f"of motion is taken for rest (least S {min(one.moving for one in found):.2f})."
    )
    return Claim(
        "Results", "E_s = 1 need not be changed for noise and drift.", measured, redone(low < E < high)
    )


def _reverse_claim(reverse: tuple[float, float]) -> Claim:
    measured = (
        f"The pseudocode says S < E_s, which the study follows. With S > E_s the clean case errs by {reverse[0]:.2f} "
        f"m at the end and {reverse[1]:.2f} m in the mean."
    )
    return Claim(
        "Key points",
        "A window is a key point where S exceeds E_s (prose).",
        measured,
        redone(reverse[0] < 0.32),
    )


def _weights_claim(shares: dict[str, tuple[float, float]]) -> Claim:
    measured = "Motion held for rest, usual weights and these: " + ", ".join(
        f"{100 * usual:.0f} and {100 * noisy:.0f} % ({name})" for name, (usual, noisy) in shares.items()
    )
    usual, noisy = shares["ten phases"]
    statement = "With noise and drift, weights 0.2, 0.4, 0.4 find key points better than 0.1, 0.45, 0.45."
    return Claim("Results", statement, measured + " of the windows.", redone(noisy < usual))


def _size_claim(found: dict[tuple[float, int], Array]) -> Claim:
    held = {size: 100.0 * float(errors[:, 2].mean()) for (_, size), errors in found.items()}
    measured = "Motion held for rest: " + ", ".join(
        f"{share:.0f} % of the windows of {size}" for size, share in held.items()
    )
    measured += ". E_s = 1 was kept: the change between two short windows is small in motion, too."
    return Claim(
        "Method", "Windows of less than 10 samples find key points less precisely.", measured,
        redone(held[5] > held[10]),
    )  # fmt: skip


def _rate_claim(found: dict[tuple[float, int], Array]) -> Claim:
    middle = {one: float(np.median(errors[:, 0])) for one, errors in found.items()}
    held = {one: 100.0 * float(errors[:, 2].mean()) for one, errors in found.items()}
    base, faster = (50.0, 10), [one for one in found if one[0] > 50.0]
    measured = "Median final error over ten phases: " + ", ".join(
        f"{error:.2f} m at {rate:g} Hz with windows of {size}" for (rate, size), error in middle.items()
    )
    measured += (
        f". Windows of the same time give the same. Shorter ones see less change in motion, so with E_s = 1 up to "
        f"{max(held.values()):.0f} % of the motion is held for rest."
    )
    better = all(middle[one] < middle[base] and held[one] <= held[base] for one in faster)
    return Claim("Conclusions", "Higher sampling rates would be better.", measured, redone(better))
