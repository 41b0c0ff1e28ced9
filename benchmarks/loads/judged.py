"""Judgement of one trial and the rows of all: which are flagged, by what, and how many spoilt frames count."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.loads.trials import Trial
from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.io.contacts import bearing
from mbkf.io.results import Reconstruction
from mbkf.numerics.threads import single_threaded
from mbkf.trial.checks import clocks, gains, mass
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct

CAUSES = (mass.NAME, clocks.NAME, gains.NAME)
"""Checks that name the cause of a contradiction."""

SPOILT_SHARE = 0.08
"""A frame under a larger unexplained load, as a share of body weight, may not count."""

VIOLATORS, CLEAN = 40, 60
MOST_ACCUSED = 1


@dataclass(frozen=True)
class Judged:
    """Judgement of a trial.

    Attributes:
        label: The trial.
        frames, valid: Number of frames, and of valid ones.
        largest: Largest missing force over half a second, share of body weight; NaN where it is not judged.
        loads: Number of unexplained loads.
        causes: Their causes, without repetition.
        checks: Checks outside that name a cause.
        credited: Parts besides the feet that are found to bear.
        spoilt: Valid frames under an unexplained load above :data:`SPOILT_SHARE`; NaN where the load is not known.
        force: Stated over true mean force while it acts; NaN likewise.
        covered: Share of the load's duration that is stated; NaN likewise.
    """

    label: str
    frames: int
    valid: int
    largest: float
    loads: int
    causes: tuple[str, ...]
    checks: tuple[str, ...]
    credited: tuple[str, ...]
    spoilt: float
    force: float
    covered: float

    @property
    def flagged(self) -> bool:
        """True where the contradiction is stated, by whatever."""
        return bool(self.loads or self.checks or self.credited)


def judged(trial: Trial) -> Judged:
    """Reconstructs and judges a trial.

    Args:
        trial: The trial.
    """
    with single_threaded():
        capture, subject, unread = trial.load()
        found = reconstruct(
            capture, subject, settings=ReconstructSettings(other_contacts=not trial.feet_only)
        )
    weight_n = subject.mass_kg * GRAVITY_M_S2
    missing = np.abs(found.unexplained_force_n)
    outside = tuple(one.name for one in found.checks if one.verdict == "outside" and one.name in CAUSES)
    credited = tuple(sorted({one.part for one in found.contacts if not one.part.endswith("foot")}))
    return Judged(
        trial.label,
        found.frames,
        int(found.valid.sum()),
        float(np.nanmax(missing) / weight_n) if np.isfinite(missing).any() else float("nan"),
        len(found.unexplained),
        tuple(dict.fromkeys(one.cause for one in found.unexplained)),
        outside,
        credited,
        *_against_truth(found, unread, weight_n),
    )


def _against_truth(
    found: Reconstruction, unread: Array | None, weight_n: float
) -> tuple[float, float, float]:
    """Valid frames under a load that no contact is credited with; stated over true force; stated share of its time.

    Args:
        found: The result.
        unread: (T, 3) the true force; None where it is not known.
        weight_n: Body weight.
    """
    if unread is None:
        return float("nan"), float("nan"), float("nan")
    frames = min(len(unread), found.frames)
    true = unread[:frames]
    credited = np.asarray(bearing(found.support_wrench[:frames]).any(axis=1))
    acts = np.asarray(np.linalg.norm(true, axis=1) > SPOILT_SHARE * weight_n) & ~credited
    stated, times = np.zeros((frames, 3)), found.times_s[:frames]
    for one in found.unexplained:
        stated[(times >= one.from_s) & (times <= one.to_s)] = one.vector_n
    said = np.asarray(stated.any(axis=1))
    size = float(np.linalg.norm(true[acts].mean(axis=0))) if acts.any() else float("nan")
    force = (
        float(np.linalg.norm(stated[acts & said].mean(axis=0))) / size
        if (acts & said).any()
        else float("nan")
    )
    return (
        float((found.valid[:frames] & acts).sum()),
        force,
        float(said[acts].mean()) if acts.any() else float("nan"),
    )


def violator_rows(found: Sequence[Judged]) -> Iterator[Check]:
    """Rows of trials in which a force acts that nothing reads, or with a fault."""
    for one in found:
        by = [*(cause or "load" for cause in one.causes), *one.checks, *one.credited]
        yield information(
            f"{one.label}: largest missing force ({', '.join(by) or 'not flagged'}; {one.valid} of {one.frames} valid)",
            100.0 * one.largest,
            "% BW",
        )
    flagged = sum(one.flagged for one in found)
    yield Check(f"violators flagged of {len(found)}", flagged, len(found), ">=")
    yield information("violators that positions and contacts alone flag", sum(one.loads > 0 for one in found))
    spoilt = [one.spoilt for one in found if np.isfinite(one.spoilt)]
    yield Check(
        f"valid frames under an unexplained load above 8 % of body weight, {len(spoilt)} trials",
        float(sum(spoilt)),
        0.0,
        "<=",
    )
    force = [one.force for one in found if np.isfinite(one.force)]
    covered = [one.covered for one in found if np.isfinite(one.covered)]
    yield information("stated over true force, least", min(force, default=float("nan")))
    yield information("stated over true force, largest", max(force, default=float("nan")))
    yield information("share of a load's duration that is stated, least", min(covered, default=float("nan")))


def clean_rows(found: Sequence[Judged]) -> Iterator[Check]:
    """Rows of clean trials."""
    judged = [one for one in found if np.isfinite(one.largest)]
    accused = [one for one in found if one.loads]
    for one in sorted(judged, key=lambda one: -one.largest)[:10]:
        yield information(f"clean, {one.label}: largest missing force", 100.0 * one.largest, "% BW")
    yield Check(
        f"clean trials accused of {len(found)}, {len(judged)} of them judged",
        len(accused),
        MOST_ACCUSED,
        "<=",
    )
