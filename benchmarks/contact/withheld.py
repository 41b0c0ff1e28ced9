"""All plates withheld: what markers and Newton's law tell of the feet's reactions, against the plates.

Four public walks are reconstructed with and without their plates by the same filter, causal, with a fixed lag of 60 ms,
and smoothed. Frames count in which every
contact is truly measured. The filter's settings for feet without a plate were set on HC032A and the rajagopal walk;
HC044A and gaitalytics were only looked at. In gaitalytics a foot lands beside the plates from 1.8 s on, which plates do
not see; frames count until then.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, Context, information
from benchmarks.contact.shared import BEARS_N, REAL_WALKS, read_walk, rms
from mbkf.conventions import GRAVITY_M_S2
from mbkf.io.records import Capture
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.sensors.contact.records import Contact
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct

MODES = {
    "causal": ReconstructSettings(smooth=False),
    "60 ms": ReconstructSettings(lag_s=0.06),
    "smoothed": ReconstructSettings(smooth=True),
}
"""Which later frames a frame knows: none, those of a fixed lag, all."""

MEASURED_UNTIL_S = {"gaitalytics": 1.8}
"""From when on, s after the first frame, a foot lands beside the plates and is still taken for one in the air: its heel
marker comes to rest 40 mm above the floor at 1.93 s, while the plates together read 77 % of body weight."""

TOTAL_PERCENT = {"causal": 9.0, "60 ms": 5.5, "smoothed": 5.0}
"""Bounds on the mean over the walks of the total vertical force's RMS, % of body weight."""

WORST_SMOOTHED, STANCE, DOUBLE = 7.5, 8.0, 12.0
PRESSURE_MM, ANKLE_NM_KG = 30.0, 0.15
PRESSED_SHARE = 0.2
"""Share of body weight from which a centre of pressure counts."""

ONE_PLATE_N = {"causal": 60.0, "smoothed": 25.0}
"""Bounds on the vertical force's RMS on a foot whose plate alone is withheld, N."""

LEAST_COVER = 90.0
"""Share of errors, %, that the stated 95 % intervals have to hold at least."""


@dataclass(frozen=True)
class Withheld:
    """How far reactions without plates are off; forces in % of body weight.

    Attributes:
        total: RMS of the vertical force on both feet.
        stance: RMS of the vertical force on a foot that bears.
        double: The same while both bear.
        pressure_mm: RMS distance of the centres of pressure.
        ankle_nm_kg: RMS of the sagittal ankle torque over body mass.
        cover: Share of vertical errors within the stated 95 % intervals, %.
        over_sd: RMS of vertical error over stated standard deviation.
    """

    total: float
    stance: float
    double: float
    pressure_mm: float
    ankle_nm_kg: float
    cover: float
    over_sd: float


def withheld_rows(context: Context) -> list[Check]:
    """The rows of the table."""
    data = context.require_data()
    found = {name: dict(_both(data, name)) for name in REAL_WALKS}
    rows = [check for mode in MODES for check in _rows(mode, {n: one[mode] for n, one in found.items()})]
    return [*rows, *_one_plate_rows(data)]


def _one_plate_rows(data: Path) -> Iterator[Check]:
    """The rajagopal walk with each of its plates withheld in turn: the worse of the two feet that stood on them."""
    subject, trial = read_walk(data, REAL_WALKS["rajagopal"])
    for mode, most_n in ONE_PLATE_N.items():
        measured = reconstruct(trial, subject, settings=MODES[mode])
        assert measured.foot_contact is not None
        off = []
        for plate in trial.plates:
            found = reconstruct(trial, subject, settings=replace(MODES[mode], without_plates=(plate.name,)))
            assert found.foot_contact is not None
            lost = (measured.foot_contact == Contact.MEASURED) & (found.foot_contact != Contact.MEASURED)
            lost &= (measured.measured & found.tracked)[:, None]
            off.append(rms((found.foot_wrench - measured.foot_wrench)[:, :, 2][lost]))
        yield Check(f"one plate withheld, rajagopal, {mode}: vertical force", max(off), most_n, "<=", "N")


def _both(data: Path, name: str) -> Iterator[tuple[str, Withheld]]:
    subject, trial = read_walk(data, REAL_WALKS[name])
    for mode, settings in MODES.items():
        measured = reconstruct(trial, subject, settings=settings)
        found, until_s = without_plates(trial, subject, settings), MEASURED_UNTIL_S.get(name, np.inf)
        yield mode, compared(measured, found, subject, until_s)


def without_plates(trial: Capture, subject: Subject, settings: ReconstructSettings) -> Reconstruction:
    """The trial with every plate withheld.

    Args:
        trial: The trial.
        subject: The person.
        settings: How it is reconstructed otherwise.
    """
    plates = tuple(plate.name for plate in trial.plates)
    return reconstruct(trial, subject, settings=replace(settings, without_plates=plates))


def compared(
    truth: Reconstruction, found: Reconstruction, subject: Subject, until_s: float = np.inf
) -> Withheld:
    """The errors where every contact is truly measured.

    Args:
        truth: With the plates.
        found: Without them.
        subject: The person.
        until_s: Time after the first frame until which they are.
    """
    weight_n = subject.mass_kg * GRAVITY_M_S2
    assert truth.foot_contact is not None and found.foot_wrench_sd is not None
    judged = truth.measured & (truth.foot_contact >= 0).all(axis=1) & found.tracked
    judged &= truth.times_s - truth.times_s[0] < until_s
    vertical = truth.foot_wrench[:, :, 2]
    off = found.foot_wrench[:, :, 2] - vertical
    bears = judged[:, None] & (truth.foot_contact == Contact.MEASURED) & (vertical > BEARS_N)
    both = bears.all(axis=1)
    apart = np.linalg.norm(found.foot_cop_m - truth.foot_cop_m, axis=2)
    pressed = bears & (vertical > PRESSED_SHARE * weight_n) & ~np.isnan(apart)
    ankles = [truth.coordinate_names.index(f"ankle_angle_{side}") for side in "rl"]
    torque = (found.moments - truth.moments)[judged][:, ankles]
    over_sd = (off / found.foot_wrench_sd[:, :, 2])[bears]
    return Withheld(
        100.0 * rms(off[judged].sum(axis=1)) / weight_n,
        100.0 * rms(off[bears]) / weight_n,
        100.0 * rms(off[both]) / weight_n,
        1e3 * rms(apart[pressed]),
        rms(torque) / subject.mass_kg,
        100.0 * float((np.abs(over_sd) <= 1.96).mean()),
        rms(over_sd),
    )


def _rows(mode: str, found: dict[str, Withheld]) -> Iterator[Check]:
    title = f"no plates, {mode}"
    mean = float(np.mean([one.total for one in found.values()]))
    yield Check(f"{title}: total vertical, mean of four walks", mean, TOTAL_PERCENT[mode], "<=", "% BW")
    for name, one in found.items():
        if mode != "smoothed":
            yield information(f"{title}, {name}: total vertical", one.total, "% BW")
            yield information(f"{title}, {name}: per foot over stance", one.stance, "% BW")
            yield information(f"{title}, {name}: per foot in double support", one.double, "% BW")
            yield information(f"{title}, {name}: sagittal ankle torque", one.ankle_nm_kg, "N m/kg")
        else:
            yield Check(f"{title}, {name}: total vertical", one.total, WORST_SMOOTHED, "<=", "% BW")
            yield Check(f"{title}, {name}: per foot over stance", one.stance, STANCE, "<=", "% BW")
            yield Check(f"{title}, {name}: per foot in double support", one.double, DOUBLE, "<=", "% BW")
            yield Check(
                f"{title}, {name}: sagittal ankle torque", one.ankle_nm_kg, ANKLE_NM_KG, "<=", "N m/kg"
            )
            yield Check(f"{title}, {name}: centre of pressure", one.pressure_mm, PRESSURE_MM, "<=", "mm")
        yield Check(f"{title}, {name}: errors within their 95 % intervals", one.cover, LEAST_COVER, ">=", "%")
        yield information(f"{title}, {name}: error over stated sd", one.over_sd)
