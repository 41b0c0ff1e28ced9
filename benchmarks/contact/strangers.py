"""Other contacts on public captures: a box lifted from the floor, and from kneeling to lying prone without plates.

The stoop lifts (M. Millard, M. Sreenivasa, K. Mombaur, Front. Robot. AI 4 (2017)) have their feet on one plate; the
second plate, under the box, is left to tell what the hands carry: what it no longer reads. The moment at L5/S1 is
compared with the one that the authors worked out from the plate upwards; their own one from the trunk downwards, which
does not know the box, differs from it by 0.54 to 0.61 N m/kg RMS.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, Context, information, within
from benchmarks.contact.shared import PASSES, rms
from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.io.capture import read_capture
from mbkf.io.dimensions import AXES
from mbkf.io.records import Capture, PlateReadings
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale

LIFTS = {"stoop1": "t169_f620f800", "stoop2": "t169_f1395f1590", "stoop3": "t169_f2101f2300"}
STANDING, LIFTER_KG = "neu_t169_f250f350.c3d", 81.7
BOX_N, BOX_SHARE, LIFTED_N = 147.0, 0.15, 40.0
FOUND_S, LEAST_R, TORQUE_NM_KG = 0.2, 0.95, 0.25
OPENED_S = 1.0
"""Causally, contacts open on the way; moments before do not know of them."""

PRONE = "KneeltoProne01_labelled.c3d"
PRONE_FROM_S, SOLDIER_KG = 5.5, 80.0
"""From when the soldier lies; his mass is not given, and forces in body weights do not depend on it."""

KNEELS_UNTIL_S = 3.4
FOOT_PERCENT, FORCE_PERCENT = 15.0, 10.0


def stranger_rows(context: Context) -> list[Check]:
    """The lifts, and the soldier."""
    data = context.require_data()
    return [*_lift_rows(data / "stoop_lift_box"), *_prone_rows(data / "autolabel_unlabelled_fullbody")]


def _lift_rows(folder: Path) -> Iterator[Check]:
    subject = scale(read_capture(folder / STANDING), mass_kg=LIFTER_KG)
    for name, frames in LIFTS.items():
        trial, load_n = lift(folder, f"{name}_{frames}")
        lifted = int(np.argmax(load_n > LIFTED_N))
        for mode, smooth in PASSES.items():
            found = reconstruct(trial, subject, settings=ReconstructSettings(smooth=smooth))
            title = f"{name}, {mode}"
            hands = [k for k, part in enumerate(found.support_names) if part.endswith("hand")]
            held = -np.nan_to_num(found.support_wrench[:, hands, 2]).sum(axis=1)
            carries = load_n[: len(held)] > 0.9 * BOX_N
            if not smooth:  # from when the contact has opened
                carries &= held != 0.0
            mean = float(held[carries].mean())
            yield from within(
                f"{title}: load on the hands", mean, (1 - BOX_SHARE) * BOX_N, (1 + BOX_SHARE) * BOX_N, "N"
            )
            yield information(
                f"{title}: its error, RMS", rms(held[carries] - load_n[: len(held)][carries]), "N"
            )
            late = (int(np.argmax(held > 0.0)) - lifted) / found.rate_hz if held.any() else float("inf")
            yield Check(f"{title}: hands found", abs(late), FOUND_S if smooth else OPENED_S, "<=", "s")
            reference = np.loadtxt(folder / "reference_l5s1" / f"{name}_l5s1Bu.csv", delimiter=",")[:, 2]
            yield from lumbosacral_rows(title, found, reference, TORQUE_NM_KG if smooth else None)
            other = found.moment("lumbar_extension")[: len(reference)] - reference[: found.frames]
            off = rms(other) / subject.mass_kg
            yield information(f"{title}: the moment at T12/L1 in its place, RMS", off, "N m/kg")
        alone = reconstruct(trial, subject, settings=ReconstructSettings(other_contacts=False))
        yield from lumbosacral_rows(f"{name}, box not looked for", alone, reference, None)


def lift(folder: Path, name: str) -> tuple[Capture, Array]:
    """A lift with the plate under the feet, and the load (T,) on the hands by the plate under the box, N.

    Args:
        folder: Folder of the capture.
        name: Name of the trial's files.
    """
    trial = read_capture(folder / f"{name}.c3d")
    read = np.loadtxt(folder / f"{name}_F1Cop1F2Cop2.csv", delimiter=",")[: len(trial.markers.times_s)]
    force, pressed = read[:, 7:10], read[:, 10:13]
    surface = float(np.median(pressed[:, 2]))
    origin = np.array([0.05, 0.0, surface])
    # The file does not say how large the plate is; both feet stand on it.
    corners = np.array([[x, y, surface] for x, y in ((0.55, -0.4), (0.55, 0.4), (-0.4, 0.4), (-0.4, -0.4))])
    moment = np.cross(pressed - origin, force)
    rate_hz = trial.markers.rate_hz
    plate = PlateReadings(
        "2", rate_hz, trial.markers.times_s[0], origin, force, moment, pressed, 10.0, corners
    )
    return Capture(trial.path, trial.markers, (plate,)), -read[:, 3]


def lumbosacral_rows(title: str, found: Reconstruction, reference: Array, bound: float | None) -> list[Check]:
    """Rows of the moment at L5/S1 both ways, against a reference (T,), N m.

    Args:
        title: Beginning of the rows' names.
        found: The result.
        reference: The trunk's extension moment at L5/S1.
        bound: Largest RMS, N m/kg; None for rows that are information.
    """
    rows = []
    for way in AXES["way"].labels:
        moment = found.trunk_moment("L5/S1", way=way)[: len(reference)]
        error = moment - reference[: len(moment)]
        off, name = rms(error) / found.subject.mass_kg, f"{title}: moment at L5/S1, {way.replace('_', '-')}"
        unit = "N m/kg"
        if bound is None:
            rows.append(information(f"{name}, RMS", off, unit))
            continue
        like = float(np.corrcoef(moment, reference[: len(moment)])[0, 1])
        rows.append(Check(f"{name}, r", like, LEAST_R, ">="))
        rows.append(Check(f"{name}, RMS", off, bound, "<=", unit))
        sd = found.trunk_moment_sd("L5/S1", way=way)[: len(reference)]
        inside = 100.0 * float((np.abs(error) <= 1.96 * sd).mean())
        rows.append(information(f"{name}, errors within their 95 % intervals", inside, "%"))
    return rows


def _prone_rows(folder: Path) -> Iterator[Check]:
    trial = read_capture(folder / PRONE)
    subject = scale(trials=[trial], mass_kg=SOLDIER_KG)
    for mode, smooth in PASSES.items():
        found = reconstruct(trial, subject, settings=ReconstructSettings(smooth=smooth))
        yield from _supported(f"kneel to prone, {mode}", found, subject)


def _supported(title: str, found: Reconstruction, subject: Subject) -> Iterator[Check]:
    weight_n = subject.mass_kg * GRAVITY_M_S2
    feet = 100.0 * np.nan_to_num(found.foot_wrench[:, :, 2]) / weight_n
    parts = 100.0 * np.nan_to_num(found.support_wrench[:, :, 2]) / weight_n
    lies, kneels = found.times_s >= PRONE_FROM_S, found.times_s < KNEELS_UNTIL_S
    yield Check(f"{title}: most on a foot while lying", float(feet[lies].max()), FOOT_PERCENT, "<=", "% BW")
    yield Check(
        f"{title}: most on the kneeling foot", float(feet[kneels][25:, 0].max()), FOOT_PERCENT, "<=", "% BW"
    )
    off = rms((feet.sum(axis=1) + parts.sum(axis=1) - 100.0)[lies])
    yield Check(f"{title}: all forces together while lying, against weight", off, FORCE_PERCENT, "<=", "% BW")
    named = {one.part for one in found.contacts if one.from_s < KNEELS_UNTIL_S}
    yield Check(f"{title}: the knee is named while kneeling", float("right_knee" in named), 1.0, ">=")
    named = {one.part for one in found.contacts if one.to_s > PRONE_FROM_S}
    trunk = {"torso", "right_knee", "left_knee", "right_elbow", "left_elbow"}
    yield Check(f"{title}: trunk, knees and elbows named while lying", float(len(trunk & named)), 5.0, ">=")
