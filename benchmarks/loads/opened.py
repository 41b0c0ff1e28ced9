"""Contacts that open while a run goes on: how late, with which force, and the moments that they change.

A causal reconstruction takes the steps of a live run. Persons 0 and 2 who stand up and hold a rail, and two lifts of a
box, were looked at while the opening was written; the others were not.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.contact.shared import rms
from benchmarks.loads.trials import Trial
from mbkf.conventions import GRAVITY_M_S2, BoolArray
from mbkf.io.contacts import bearing
from mbkf.io.results import Reconstruction
from mbkf.numerics.runs import runs
from mbkf.numerics.threads import single_threaded
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct

CAUSAL = ReconstructSettings(smooth=False, correct_markers=False, checks=False)
SMOOTHED = ReconstructSettings(correct_markers=False, checks=False)

LATEST_S, LEAST_OPENED = 1.0, 0.95
"""A contact opens no later than this after it bears 8 % of body weight, in this share of cases."""

LOADED_SHARE = 0.08
FORCE_SHARE = 0.15
"""Mean force on open contacts over the true one."""

LEAST_S = 0.3
"""Contacts that are shorter are not asked for: LATEST_S holds for those that last."""

MOMENTS = ("hip_flexion_r", "hip_flexion_l", "lumbar_extension")


@dataclass(frozen=True)
class Opened:
    """Contacts of a trial.

    Attributes:
        label: The trial.
        late_s: How late each contact opens; infinite where it does not.
        force: Mean stated over mean true force in frames with an open contact.
        moment: RMS difference of hip and lumbar moments from the smoothed result there, N m/kg.
        valid: Share of these frames in which loads may be used, and smoothed.
    """

    label: str
    late_s: tuple[float, ...]
    force: float
    moment: float
    valid: tuple[float, float]


def contact_trials(data: Path, quick: bool) -> list[Trial]:
    """Trials with a contact besides the feet."""
    own = [("sit_to_stand", seed) for seed in (0, 2, 3, 4, 5, 6)] + [("rail", seed) for seed in (0, 3, 4)]
    found = [Trial("own", motion, data, seed, feet_only=True) for motion, seed in own]
    found += [Trial("lift", name, data, feet_only=True) for name in ("stoop1", "stoop2", "stoop3")]
    return found[::6] if quick else found


def opened(trial: Trial) -> Opened:
    """Follows a trial causally.

    Args:
        trial: The trial.
    """
    with single_threaded():
        capture, subject, unread = trial.load()
        found, later = (reconstruct(capture, subject, settings=one) for one in (CAUSAL, SMOOTHED))
    assert unread is not None, "the force on other parts is known"
    frames = min(found.frames, len(unread))
    weight_n, bears = subject.mass_kg * GRAVITY_M_S2, _bears(found)[:frames]
    acts = np.asarray(np.linalg.norm(unread[:frames], axis=1) > LOADED_SHARE * weight_n)
    late_s = []
    for first, after in runs(acts):
        if after - first >= LEAST_S * found.rate_hz and not bears[first]:
            seen = np.flatnonzero(bears[first:after])
            late_s.append(float(seen[0]) / found.rate_hz if len(seen) else float("inf"))
    both = bears & acts
    stated = np.nan_to_num(found.support_wrench[:frames, :, :3]).sum(axis=1)
    off = [(found.moment(name) - later.moment(name))[:frames][both] for name in MOMENTS]
    return Opened(
        trial.label,
        tuple(late_s),
        float(np.linalg.norm(stated[both].mean(axis=0)) / np.linalg.norm(unread[:frames][both].mean(axis=0))),
        max(rms(one[np.isfinite(one)]) for one in off) / subject.mass_kg,
        (float(found.valid[:frames][both].mean()), float(later.valid[:frames][both].mean())),
    )


def opened_rows(data: Path, quick: bool) -> Iterator[Check]:
    """Rows of contacts that open on the way."""
    yield from rows_of([opened(trial) for trial in contact_trials(data, quick)])


def rows_of(found: Sequence[Opened]) -> Iterator[Check]:
    """Rows of trials with contacts.

    Args:
        found: The trials.
    """
    late_s = [late for one in found for late in one.late_s]
    share = float(np.mean(np.array(late_s) <= LATEST_S)) if late_s else 0.0
    yield Check(
        f"live: contacts that open within {LATEST_S} s, of {len(late_s)}",
        100.0 * share,
        100.0 * LEAST_OPENED,
        ">=",
        "%",
    )
    yield information("live: latest opening of a contact", max(late_s, default=float("nan")), "s")
    for one in found:
        yield Check(
            f"live, {one.label}: force on open contacts over the true one, off by",
            abs(one.force - 1.0),
            FORCE_SHARE,
            "<=",
        )
        yield information(f"live, {one.label}: hip and lumbar moments beside smoothed", one.moment, "N m/kg")
        causal, smoothed = (100.0 * share for share in one.valid)
        yield information(
            f"live, {one.label}: valid frames on open contacts (smoothed {smoothed:.0f} %)", causal, "%"
        )


def _bears(found: Reconstruction) -> BoolArray:
    """(T,) frames with a contact besides the feet."""
    if not found.support_names:
        return np.zeros(found.frames, dtype=bool)
    return np.asarray(bearing(found.support_wrench).any(axis=1))
