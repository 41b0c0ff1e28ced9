"""Persons whose plates are withheld: do the stated forces and moments hold the truth in frames that count?

The made double supports share forces without a push between the feet, unlike walking people, whose forces point to the
pelvis: their covers show that the push is stated as unknown, not that its mean is right.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin

from benchmarks.checks import Check, information, within
from benchmarks.foreign.centres import hip_in_pelvis
from benchmarks.foreign.errors import judged
from benchmarks.foreign.followed import SCALINGS
from benchmarks.foreign.score import cover
from benchmarks.foreign.truth import TO_OURS, Foreigner
from mbkf.conventions import GRAVITY_M_S2, SIDES, Array
from mbkf.io.results import Reconstruction
from mbkf.model.human import HumanModel
from mbkf.numerics.runs import runs
from mbkf.numerics.threads import single_threaded
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale

MOTIONS = ("walk", "squat", "run", "jump")
COVER = (0.88, 0.97)
BEARS_N = 20.0
"""Vertical force, stated or true, from which a foot's force counts."""

IMPULSE = {True: 1.0, False: 2.0}
"""Bounds of the mean force against the change of momentum, % of body weight, with and without plates."""


@dataclass(frozen=True)
class Followed:
    """One motion, with or without its plates.

    Attributes:
        person, motion: Whose, and which.
        plates: True with plates.
        valid: Share of valid frames.
        force, force_sd: (n,) errors of the components of loaded feet's forces in valid frames, and their stated
            standard deviations, in body weights.
        moment, moment_sd: (m,) the same of the legs' moments, N m/kg.
        impulse: (3,) mean force less change of momentum over time, in body weights.
    """

    person: str
    motion: str
    plates: bool
    valid: float
    force: Array
    force_sd: Array
    moment: Array
    moment_sd: Array
    impulse: Array


def without_plates(person: Foreigner) -> list[Followed]:
    """The motions of a person, with plates and with all plates withheld; scaled from standing, walk and squat.

    Args:
        person: The person.
    """
    with single_threaded():
        held = [person.trial(name) for name in SCALINGS["session"] if name in person.motions]
        subject = scale(person.static(), held, mass_kg=person.mass_kg)
        truths = {name: person.truth(name) for name in person.motions}
        hips = {side: hip_in_pelvis(list(truths.values()), side) for side in SIDES}
        found = []
        for motion in (name for name in MOTIONS if name in person.motions):
            trial = person.trial(motion)
            for plates in (True, False):
                left_out = () if plates else tuple(plate.name for plate in trial.plates)
                settings = replace(ReconstructSettings(checks=False), without_plates=left_out)
                result = reconstruct(trial, subject, settings=settings)
                moments = judged(person.name, motion, result, truths[motion], hips).moments
                true_n = _true_forces(person, motion, result.times_s)
                force, force_sd = _forces(result, true_n, person.mass_kg)
                found.append(
                    Followed(
                        person.name,
                        motion,
                        plates,
                        float(result.valid.mean()),
                        force,
                        force_sd,
                        np.concatenate([one.error[result.valid] for one in moments]),
                        np.concatenate([one.sd[result.valid] for one in moments]),
                        impulse_misfit(result),
                    )
                )
        return found


def _true_forces(person: Foreigner, motion: str, times_s: Array) -> Array:
    """(T, 2, 3) true forces on right and left foot at times, world axes, N."""
    with np.load(person.folder / motion / "truth.npz") as held:
        known, forces = np.asarray(held["t"], float), np.asarray(held["W"], float)[:, :, :3]
    columns = forces.reshape(len(forces), 6).T
    there = np.column_stack([np.interp(times_s, known, one) for one in columns])
    return np.asarray(there.reshape(-1, 2, 3) @ TO_OURS.T)


def _forces(found: Reconstruction, true_n: Array, mass_kg: float) -> tuple[Array, Array]:
    """Errors of loaded feet's forces in valid frames and their standard deviations, in body weights."""
    assert found.foot_wrench_sd is not None  # the dynamic filter's
    stated, weight_n = found.foot_wrench[:, :, :3], mass_kg * GRAVITY_M_S2
    bears = np.maximum(np.abs(stated[:, :, 2]), true_n[:, :, 2]) > BEARS_N
    counts = bears & found.valid[:, None]
    return (
        ((stated - true_n)[counts] / weight_n).ravel(),
        (found.foot_wrench_sd[:, :, :3][counts] / weight_n).ravel(),
    )


def impulse_misfit(found: Reconstruction) -> Array:
    """(3,) mean force on the body less the change of its momentum over time, body weights; longest tracked stretch.

    Args:
        found: The result.
    """
    first, after = max(runs(found.tracked), key=lambda run: run[1] - run[0])
    model, mass = HumanModel.of(found.subject), found.subject.mass_kg
    data = model.pin_model.createData()

    def momentum(frame: int) -> Array:
        pin.centerOfMass(model.pin_model, data, found.q[frame], found.v[frame])
        return mass * np.array(data.vcom[0])

    part = slice(first, after)
    force = found.foot_wrench[part, :, :3].sum(axis=1)
    force = force + np.nan_to_num(found.support_wrench[part, :, :3]).sum(axis=1)
    force[:, 2] -= mass * GRAVITY_M_S2
    times = found.times_s[part]
    total = np.trapezoid(force, times, axis=0) - (momentum(after - 1) - momentum(first))
    return np.asarray(total / (times[-1] - times[0]) / (mass * GRAVITY_M_S2))


def plate_free_rows(label: str, found: Sequence[Followed]) -> list[Check]:
    """Covers without plates by motion, where frames count; impulse with and without plates.

    Args:
        label: Whose rows they are.
        found: Their motions.
    """
    rows = []
    for motion in MOTIONS:
        held = [one for one in found if one.motion == motion and not one.plates]
        if not held:
            continue
        name = f"{label}, no plates, {motion}"
        rows.append(information(f"{name}: valid frames", float(np.mean([one.valid for one in held]))))
        force, force_sd, moment, moment_sd = (
            np.concatenate([getattr(one, part) for one in held])
            for part in ("force", "force_sd", "moment", "moment_sd")
        )
        if not force.size:
            continue
        rows.append(information(f"{name}: forces of feet in 95 % intervals", cover(force, force_sd)))
        rows.append(information(f"{name}: moments of legs in 95 % intervals", cover(moment, moment_sd)))
        both = cover(np.append(force, moment), np.append(force_sd, moment_sd))
        rows += within(f"{name}: forces and moments in 95 % intervals", both, *COVER)
    for plates, bound in IMPULSE.items():
        sizes = [100.0 * float(np.linalg.norm(one.impulse)) for one in found if one.plates == plates]
        name = f"{label}, {'with' if plates else 'no'} plates: mean force against change of momentum, largest"
        rows.append(Check(name, max(sizes, default=float("nan")), bound, "<=", "% BW"))
    return rows
