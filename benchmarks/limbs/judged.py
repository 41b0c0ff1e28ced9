"""Cases judged: is the limb where the trial without a fault has it, from when on, and is the fault reported."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.limbs.faults import HIDDEN, HIDDEN_S, KINDS, NAMES, ThrownFilter, exchanged
from benchmarks.limbs.trials import CHOSEN_ON, Case, loaded
from mbkf.conventions import Array
from mbkf.filters.fixed_lag import SmoothingSettings
from mbkf.filters.record import Track
from mbkf.filters.tracking import track
from mbkf.io.records import MarkerTrajectories
from mbkf.model.body import Body
from mbkf.model.limbs import Limb, limbs
from mbkf.numerics.threads import single_threaded
from mbkf.scaling.correction import correct_markers
from mbkf.sensors.limb_fit import LEAST_SEEN
from mbkf.trial.preparation.exchanged import names_put_right
from mbkf.trial.preparation.filters import tracking_filter
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.selection import subject_markers
from mbkf.trial.preparation.settings import ReconstructSettings

WITHIN_RAD = np.radians(10.0)
"""A limb is right where no joint is further (RMS over the frames judged) from the trial without a fault."""

SOON_S = 0.3
"""Causally, frames are judged from this long after the fault on; smoothed, from the fault on."""


@dataclass(frozen=True)
class Judged:
    """A case by one way of filtering.

    Attributes:
        case: The case.
        way: "causal" or "smoothed", with the filter.
        off_rad: Furthest joint of the limb, RMS over the frames judged.
        reported: The fault is stated; of a clean trial, anything is.
        said: The statements.
    """

    case: Case
    way: str
    off_rad: float
    reported: bool
    said: tuple[str, ...]

    @property
    def mended(self) -> bool:
        """True where the limb is right."""
        return self.off_rad <= WITHIN_RAD


WAYS = (("dynamic", True), ("dynamic", False), ("kinematic", True), ("kinematic", False))


def judged(case: Case) -> list[Judged]:
    """A case by all ways; empty where too few markers show the limb."""
    if case.kind and not shown(case):
        return []
    with single_threaded():
        return [one for filter, smooth in WAYS for one in _judged(case, filter, smooth)]


@cache
def _right(data: Path, trial: str, filter: str, smooth: bool) -> tuple[Track, Body]:
    """The trial without a fault."""
    case = Case(data, trial)
    found, model, _ = _tracked(case, filter, smooth)
    return found, model


def _judged(case: Case, filter: str, smooth: bool) -> list[Judged]:
    way = f"{filter}, {'smoothed' if smooth else 'causal'}"
    right, model = _right(case.data, case.trial, filter, smooth)
    if not case.kind:
        said = tuple(one.sentence for one in right.limb_doubts)
        return [Judged(case, way, 0.0, bool(said), said)]
    found, _, told = _tracked(case, filter, smooth)
    limb = _limb(model, case.limb)
    frames, dt = len(right.q), 1.0 / loaded(case.data, case.trial)[0].markers.rate_hz
    first = _frame(case, frames) + (0 if smooth else round(SOON_S / dt))
    dofs = _seen_dofs(case, model, limb)
    apart = np.array(
        [model.difference(a, b)[dofs] for a, b in zip(right.q[first:], found.q[first:], strict=True)]
    )
    off = float(np.sqrt((apart**2).mean(axis=0)).max()) if np.isfinite(apart).all() else np.inf
    said = (*told, *(one.sentence for one in found.limb_doubts))
    return [Judged(case, way, off, bool(said), said)]


def _seen_dofs(case: Case, model: Body, limb: Limb) -> Array:
    """Dofs of the limb's joints up to the last segment that carries markers."""
    segments = {marker.segment for marker in loaded(case.data, case.trial)[1].markers}
    shown = [one.joint_id for one in limb.joints if one.segment in segments]
    return np.array([dof for dof in limb.dofs if model.supports[shown, dof].any()])


def _tracked(case: Case, filter: str, smooth: bool) -> tuple[Track, Body, tuple[str, ...]]:
    """The track, the body, and names put right before."""
    capture, subject = loaded(case.data, case.trial)
    measured, _ = names_put_right(subject_markers(capture.markers, subject), subject)
    told: tuple[str, ...] = ()
    subject = correct_markers(subject, measured)
    settings = ReconstructSettings(filter=filter, smooth=smooth)
    inputs, recording = trial_inputs(measured, (), subject, settings)
    model, made = inputs.sensor.model, tracking_filter(filter, inputs)
    if case.kind:
        limb, frame = _limb(model, case.limb), _frame(case, measured.frames)
        if case.kind in NAMES:
            rng = np.random.default_rng(case.seed)
            wrong = exchanged(case.kind, inputs.sensor, limb, measured.positions_m, frame, rng)
            named = replace(measured, positions_m=wrong)
            if smooth:
                named, pairs = names_put_right(named, subject)
                told = tuple(f"{a} and {b}" for a, b, _ in pairs)
            recording = replace(recording, markers_m=named.positions_m)
        else:
            if case.kind in HIDDEN:
                recording = replace(
                    recording, markers_m=_hidden(measured, inputs.sensor.segments, limb, frame)
                )
            made = ThrownFilter(made, case.kind, limb, frame)
    smoothing = SmoothingSettings() if smooth else None
    return track(made, recording, smoothing=smoothing, spreads=()), model, told


def _hidden(measured: MarkerTrajectories, segments: Sequence[str], limb: Limb, frame: int) -> Array:
    own = np.isin(np.array(segments), [joint.segment for joint in limb.joints])
    found = measured.positions_m.copy()
    begin = max(1, frame - round(HIDDEN_S * measured.rate_hz))
    found[begin:frame, own] = np.nan
    return found


def _limb(model: Body, name: str) -> Limb:
    return next(one for one in limbs(model) if one.name == name)


def _frame(case: Case, frames: int) -> int:
    return round(case.at * frames)


def shown(case: Case) -> bool:
    """True where enough markers show the limb for a fault of it to be seen."""
    _, subject = loaded(case.data, case.trial)
    parts = {"thigh": ("thigh", "shank", "foot", "toes"), "arm": ("upper_arm", "forearm", "hand")}
    side, which = case.limb.split("_", 1)
    of = {f"{side}_{one}" for one in parts["thigh" if which == "thigh" else "arm"]}
    return sum(marker.segment in of for marker in subject.markers) >= LEAST_SEEN


def rows(found: Iterable[Sequence[Judged]], right: Iterable[Sequence[Judged]]) -> list[Check]:
    """Rows of all cases and clean trials."""
    every = [one for of_case in found for one in of_case]
    checks = []
    for title, chosen in (("chosen on", True), ("shown", False)):
        some = [one for one in every if (one.case.trial in CHOSEN_ON) == chosen]
        for way in dict.fromkeys(one.way for one in some):
            own = [one for one in some if one.way == way]
            checks.append(
                Check(f"{title}, {way}: limbs mended", _share(o.mended for o in own), 97.0, ">=", "%")
            )
            checks.append(
                Check(f"{title}, {way}: limbs reported", _share(o.reported for o in own), 100.0, ">=", "%")
            )
    for kind in KINDS:
        checks.append(
            information(f"{kind}: mended, %", _share(one.mended for one in every if one.case.kind == kind))
        )
    said = [one for of_case in right for one in of_case if one.reported]
    checks.append(information("clean trials with a limb in doubt, of four ways each", float(len(said))))
    return checks


def _share(of: Iterable[bool]) -> float:
    found = list(of)
    return 100.0 * sum(found) / len(found) if found else np.nan
