"""Two feet on one plate or belt, against plates of their own and against exact truth.

Real walks: all plates' readings are added into one plate, and the feet's forces compared with those that the same
filter finds on the separate plates. Synthetic ones are compared with the truth. The constants of the shares were set on
HC032A and gaitalytics (:mod:`mbkf.sensors.contact.sharing`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, Context, information, within
from benchmarks.contact.joining import joined, on_belt
from benchmarks.contact.standing import PERSONS, WIDTHS_M, motion_of
from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.sensors.contact.records import Contact
from mbkf.synthesis.capture import CaptureSettings
from mbkf.synthesis.person import body_of
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale
from mbkf.trial.synth import synthesise

BEARS_N = 20.0
"""Vertical force from which a foot bears."""

WALK_S, STAND_S, BELT_M_S, SEED = 4.0, 3.0, 1.2, 5
SETTLED_S = 0.25
"""A filter that begins over both feet does not count before this."""

JOINTS = {"ankle": "foot", "knee": "shank", "hip": "thigh"}
PASSES = {"causal": False, "smoothed": True}
REAL_DOUBLE, REAL_STANCE = 4.0, 2.5
WALK_DOUBLE = {"causal": 4.0, "smoothed": 3.0}
STANDING = dict(zip(WIDTHS_M, (10.0, 5.0, 4.0), strict=True))
TORQUE_RATIO = 1.5
SPREAD = (0.7, 1.3)
_PLATES = CaptureSettings(offset_n=(0.0, 0.0))


@dataclass(frozen=True)
class RealWalk:
    """A public walk over several plates: names of its files, mass, and whether it is scaled from a static trial."""

    trial: str
    static: str | None
    mass_kg: float
    forces: str | None = None


REAL_WALKS = {
    "HC032A": RealWalk(
        "biomechzoo_walk_turn/HC032A_Straight_HC032A03.c3d",
        "biomechzoo_walk_turn/HC032A_Static_HC032A01.c3d",
        60.3,
    ),
    "HC044A": RealWalk(
        "biomechzoo_walk_turn/HC044A_Straight_HC044A15.c3d",
        "biomechzoo_walk_turn/HC044A_Static_HC044A01.c3d",
        39.4,
    ),
    "gaitalytics": RealWalk("gaitalytics_walk/overground_fullbody_4plates.c3d", None, 63.6),
    "rajagopal": RealWalk(
        "rajagopal_walk_run/motion_capture_walk.trc",
        "rajagopal_walk_run/static_walk_1.trc",
        85.07,
        "rajagopal_walk_run/grf_walk.mot",
    ),
}


@dataclass(frozen=True)
class Errors:
    """How far the feet's forces are off.

    Attributes:
        force_n: (n, 2) vertical error in frames in which both feet bear.
        stance_n: (m,) vertical error wherever a foot bears.
        over_sd: (n, 2) the first over its stated standard deviation.
        unshared: Frames in which both feet bear and no plate was seen to be shared.
        weight_n: Body weight.
    """

    force_n: Array
    stance_n: Array
    over_sd: Array
    unshared: int
    weight_n: float

    @property
    def double_percent(self) -> float:
        """RMS in frames in which both feet bear, % of body weight."""
        return 100.0 * rms(self.force_n) / self.weight_n

    @property
    def stance_percent(self) -> float:
        """RMS over stance, % of body weight."""
        return 100.0 * rms(self.stance_n) / self.weight_n

    @property
    def spread(self) -> float:
        """RMS of error over stated standard deviation."""
        return rms(self.over_sd)


def shared_rows(context: Context) -> list[Check]:
    """Real walks, synthetic walks on floor and belt, standing and squats; with quick, the real ones are left out."""
    spreads: dict[str, list[float]] = {name: [] for name in PASSES}
    rows = [] if context.quick else list(_real_rows(context.require_data(), spreads))
    rows += [*_walk_rows(spreads), *_standing_rows(spreads)]
    for name, found in spreads.items():
        rows += within(f"shared, all captures, {name}: error over stated sd", rms(np.array(found)), *SPREAD)
    return rows


def rms(values: Array) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def errors(found: Reconstruction, true: Array, bears: BoolArray, weight_n: float) -> Errors:
    """Vertical errors of a reconstruction.

    Args:
        found: The reconstruction.
        true: (T, 2, 6) reference wrenches.
        bears: (T, 2) feet that bear and whose reference is known.
        weight_n: Body weight.
    """
    assert found.foot_wrench_sd is not None and found.foot_contact is not None  # the dynamic filter's
    both = bears.all(axis=1)
    off = (found.foot_wrench - true)[:, :, 2]
    apart = (found.foot_contact[both] != Contact.SHARED).any(axis=1)
    return Errors(
        off[both], off[bears], off[both] / found.foot_wrench_sd[both][:, :, 2], int(apart.sum()), weight_n
    )


def _follow(capture: Capture, subject: Subject, name: str) -> Reconstruction:
    settings = ReconstructSettings(filter="dynamic", smooth=PASSES[name])
    return reconstruct(capture, subject, settings=settings)


def read_walk(data: Path, walk: RealWalk) -> tuple[Subject, Capture]:
    """A real walk and the person scaled for it.

    Args:
        data: Folder of the reference captures.
        walk: The walk.
    """
    trial = read_capture(data / walk.trial, forces=None if walk.forces is None else data / walk.forces)
    if walk.static is None:
        return scale(trials=[trial], mass_kg=walk.mass_kg), trial
    return scale(read_capture(data / walk.static), mass_kg=walk.mass_kg), trial


def _real_rows(data: Path, spreads: dict[str, list[float]]) -> Iterator[Check]:
    for person, walk in REAL_WALKS.items():
        subject, trial = read_walk(data, walk)
        for name in PASSES:
            apart = _follow(trial, subject, name)
            assert apart.foot_contact is not None  # the dynamic filter's
            bears = (apart.foot_contact == Contact.MEASURED) & (apart.foot_wrench[:, :, 2] > BEARS_N)
            off = errors(
                _follow(joined(trial), subject, name), apart.foot_wrench, bears, walk.mass_kg * GRAVITY_M_S2
            )
            spreads[name].append(off.spread)
            label = f"shared, {person}, {name}"
            yield Check(
                f"{label}: force per foot, double support", off.double_percent, REAL_DOUBLE, "<=", "% BW"
            )
            yield Check(f"{label}: force per foot, stance", off.stance_percent, REAL_STANCE, "<=", "% BW")
            yield information(f"{label}: error over stated sd", off.spread)
            yield information(f"{label}: frames of double support not seen as shared", off.unshared)
            both = (apart.foot_contact == Contact.SHARED).any(axis=1).sum()
            yield Check(f"{label}: frames seen as shared on separate plates", float(both), 0.0, "<=")


def _walk_rows(spreads: dict[str, list[float]]) -> Iterator[Check]:
    """A synthetic walk over separate plates, over one, and over one belt."""
    subject, made = synthesise("walk", seconds=WALK_S, seed=SEED, settings=_PLATES)
    truth, weight = made.truth, subject.mass_kg * GRAVITY_M_S2
    bears = (truth.foot_wrench[:, :, 2] > BEARS_N) & (truth.times_s >= SETTLED_S)[:, None]
    both = np.asarray(bears.all(axis=1))
    one = joined(made.trial)
    for name in PASSES:
        usual = _torque_errors(_follow(made.trial, subject, name), truth.tau, both, subject)
        for ground, capture, speed in (("floor", one, 0.0), ("belt", on_belt(one, BELT_M_S), BELT_M_S)):
            found = _follow(capture, subject, name)
            off = errors(found, moved_back(truth.foot_wrench, truth.times_s, speed), bears, weight)
            spreads[name].append(off.spread)
            label = f"shared, synthetic walk, {ground}, {name}"
            bound = WALK_DOUBLE[name]
            yield Check(f"{label}: force per foot, double support", off.double_percent, bound, "<=", "% BW")
            yield information(f"{label}: error over stated sd", off.spread)
            yield information(f"{label}: frames of double support not seen as shared", off.unshared)
            for joint, (error, over_sd) in _torque_errors(found, truth.tau, both, subject).items():
                torque = f"{label}: {joint} torque, double support"
                ratio = error / usual[joint][0]
                yield Check(f"{torque}, over that of separate plates", ratio, TORQUE_RATIO, "<=")
                yield information(f"{torque}, RMS", error, "N m/kg")
                yield information(f"{torque}, error over stated sd", over_sd)


def moved_back(wrench: Array, times_s: Array, speed_m_s: float) -> Array:
    """(T, 2, 6) wrenches about the world's origin whose points move back with a belt.

    Args:
        wrench: (T, 2, 6) on the floor.
        times_s: (T,) times.
        speed_m_s: Speed of the belt.
    """
    moved = wrench.copy()
    back = np.outer(times_s, [-speed_m_s, 0.0, 0.0])[:, None]
    moved[:, :, 3:] += np.cross(back, wrench[:, :, :3])
    return moved


def _torque_errors(
    found: Reconstruction, true: Array, frames: BoolArray, subject: Subject
) -> dict[str, tuple[float, float]]:
    """RMS torque error per joint, N m/kg, and RMS of error over stated standard deviation.

    Args:
        found: A reconstruction.
        true: (T, nv) true generalised forces.
        frames: (T,) frames that count.
        subject: Whose.
    """
    model, off, sd = body_of(subject), (found.tau - true)[frames], found.sd_tau[frames]
    errors_of = {}
    for joint, segment in JOINTS.items():
        own = np.r_[tuple(model.joint(f"{side}_{segment}").v for side in ("right", "left"))]
        errors_of[joint] = rms(off[:, own]) / subject.mass_kg, rms(off[:, own] / sd[:, own])
    return errors_of


def _standing_rows(spreads: dict[str, list[float]]) -> Iterator[Check]:
    """Standing and squats on one plate by width of the stance, over both persons."""
    for kind in ("stand", "squat"):
        for width, bound in STANDING.items():
            for name in PASSES:
                each = [_standing(kind, width, person, name) for person in PERSONS]
                percent = rms(np.array([off.double_percent for off in each]))
                spread = rms(np.array([off.spread for off in each]))
                spreads[name].append(spread)
                label = f"shared, {kind}, feet {100 * width:.0f} cm apart, {name}"
                yield Check(f"{label}: force per foot", percent, bound, "<=", "% BW")
                yield from within(f"{label}: error over stated sd", spread, *SPREAD)


def _standing(kind: str, width_m: float, person: str, name: str) -> Errors:
    """Errors of one person.

    Args:
        kind: stand or squat.
        width_m: Distance of the ankles.
        person: Where the feet are pressed.
        name: causal or smoothed.
    """
    subject, made = synthesise(motion_of(kind, width_m, person), seconds=STAND_S, seed=SEED, settings=_PLATES)
    bears = np.repeat(made.truth.times_s[:, None] >= SETTLED_S, 2, axis=1)
    found = _follow(joined(made.trial), subject, name)
    return errors(found, made.truth.foot_wrench, bears, subject.mass_kg * GRAVITY_M_S2)
