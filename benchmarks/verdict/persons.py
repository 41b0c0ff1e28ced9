"""Subject files of other persons: pairs of public captures, and of synthetic persons that nobody looked at.

The bounds of segment lengths (:mod:`mbkf.trial.checks.persons`) are powers of ten. They were set while the public pairs
and persons made from OpenSim bodies (*fields* skin) were looked at; the synthetic pairs show them. A pair counts whose
subject file knows at least half of the trial's markers: others are refused for that.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.dynamic.captures import Source
from benchmarks.loads.trials import ALL_SOURCES
from mbkf.errors import MbkfError
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.subject import Subject
from mbkf.numerics.threads import single_threaded
from mbkf.synthesis.person import synthesise_subject
from mbkf.trial.checks.persons import LOOK, NAME
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale
from mbkf.trial.synth import synthesise
from mbkf.trial.verdict.judge import verdict_of

MORE: Mapping[str, Source] = {
    "HC032A": Source(
        "biomechzoo_walk_turn", "HC032A_Straight_HC032A03.c3d", 60.3, "HC032A_Static_HC032A01.c3d"
    ),
    "HC044A": Source(
        "biomechzoo_walk_turn", "HC044A_Straight_HC044A15.c3d", 39.4, "HC044A_Static_HC044A01.c3d"
    ),
    "bmc": Source("bmc_walk_run", "run.trc", 70.0, "run_static.trc", "run_grf.mot"),
    "functional": Source("functional_walk", "FunctionalWalk.c3d", 60.0, "FunctionalStatic.c3d"),
    "gaitalytics": Source("gaitalytics_walk", "overground_fullbody_4plates.c3d", 70.0),
    "jam": Source("jam_walk", "static1.trc", 70.0, "static1.trc"),
    "landing": Source("landings", "doubleLegLanding.c3d", 39.0),
    "stoop lift": Source("stoop_lift_box", "stoop1_t169_f620f800.c3d", 80.0, "neu_t169_f250f350.c3d"),
    "unipd": Source("unipd_walk", "Walking1.c3d", 70.0, "Static1.c3d"),
    "opensim gappy": Source("opensim_gappy_walk", "walking2.c3d", 70.0),
    "c3d Eb015": Source("c3d_encodings", "Eb015pr.c3d", 60.0),
}
"""Persons besides those of :data:`benchmarks.loads.trials.ALL_SOURCES`; masses of 70 kg are not known, that of
the landing is its impulse."""

PUBLIC: Mapping[str, tuple[str, ...]] = {
    "HC032A": ("HC044A", "cgm24", "flywheel", "gaitalytics", "stoop lift"),
    "HC044A": ("HC032A", "cgm24", "flywheel", "gaitalytics", "stoop lift"),
    "rehazenter": ("unipd", "c3d Eb015"),
    "cgm24": ("HC032A", "HC044A", "flywheel", "gaitalytics", "functional", "stoop lift"),
    "bmc": ("rajagopal run",),
    "flywheel": ("HC032A", "HC044A", "cgm24", "gaitalytics", "functional", "stoop lift"),
    "rajagopal walk": ("jam",),
    "rajagopal run": ("bmc",),
    "gaitalytics": ("HC032A", "HC044A", "cgm24", "flywheel", "stoop lift"),
    "landing": ("rajagopal walk", "jam"),
    "opensim gappy": ("bmc", "rajagopal run"),
    "stoop lift": ("HC032A", "HC044A", "cgm24", "flywheel", "gaitalytics"),
}
"""Subject files by trial, of other persons whose files know half of the trial's markers. The walk of OpenSim's test
data and the landing are left out as a pair: they may be of one person."""

OWN_SEEDS = tuple(range(30, 42))
"""Synthetic persons that no bound was set on."""

LEAST_REPORTED = 100.0 * 28 / 30
"""Pairs that are reported, per cent."""

MOST_FRAMES = 150
"""Frames of a trial that are reconstructed."""


@dataclass(frozen=True)
class Pair:
    """A trial with a subject file.

    Attributes:
        trial, file: Names of the persons, or seeds of synthetic ones.
        data: Folder of the reference captures.
        plates: False for the markers alone.
    """

    trial: str
    file: str
    data: Path
    plates: bool = True

    @property
    def own(self) -> bool:
        """True where the file belongs to the person in the trial."""
        return self.trial == self.file

    def load(self) -> tuple[Capture, Subject]:
        """The trial and the file."""
        if self.trial.isdecimal():
            _, made = synthesise("walk", seed=int(self.trial))
            capture, subject = made.trial, synthesise_subject(int(self.file))
        else:
            capture, subject = capture_of(self.trial, self.data), subject_of(self.file, self.data)
        return replace(_cut(capture), plates=capture.plates if self.plates else ()), subject


@dataclass(frozen=True)
class Accused:
    """Judgement of a pair.

    Attributes:
        pair: The pair.
        word: The word on the trial; "refused" if `reconstruct` refuses it.
        powers: Powers of ten for another person; NaN where it is refused.
        line: The verdict in a line.
    """

    pair: Pair
    word: str
    powers: float
    line: str


def _cut(capture: Capture) -> Capture:
    """A capture with :data:`MOST_FRAMES` frames at most, about the middle of those that show most markers."""
    shown = capture.markers.present.sum(axis=1)
    most = np.flatnonzero(shown >= 0.9 * shown.max())
    first = max(0, int(most[len(most) // 2]) - MOST_FRAMES // 2)
    markers = capture.markers
    kept = MarkerTrajectories(
        markers.names,
        markers.positions_m[first : first + MOST_FRAMES],
        markers.rate_hz,
        markers.start_time_s + first / markers.rate_hz,
    )
    return replace(capture, markers=kept)


def _source(name: str) -> Source:
    return MORE.get(name) or ALL_SOURCES[name]


def capture_of(name: str, data: Path) -> Capture:
    """The trial of a public person.

    Args:
        name: The person.
        data: Folder of the reference captures.
    """
    source = _source(name)
    folder = data / source.folder
    return read_capture(folder / source.trial, forces=source.forces and folder / source.forces)


def subject_of(name: str, data: Path) -> Subject:
    """The subject file of a public person.

    Args:
        name: The person.
        data: Folder of the reference captures.
    """
    source = _source(name)
    if source.static is None:
        return scale(None, [capture_of(name, data)], mass_kg=source.mass_kg)
    return scale(read_capture(data / source.folder / source.static), mass_kg=source.mass_kg)


def pairs(data: Path, quick: bool = False) -> list[Pair]:
    """Right and wrong pairs, with plates and without.

    Args:
        data: Folder of the reference captures.
        quick: Every tenth of them.
    """
    names = sorted({*PUBLIC, *(name for files in PUBLIC.values() for name in files)} - {"jam"})
    found = [Pair(name, name, data) for name in names]  # jam's static and walk have different marker sets
    found += [
        Pair(trial, file, data, plates)
        for plates in (True, False)
        for trial, files in PUBLIC.items()
        for file in files
    ]
    found += [Pair(str(seed), str(seed), data, plates=False) for seed in OWN_SEEDS]
    shifted = zip(OWN_SEEDS, islice(OWN_SEEDS, 1, None), strict=False)
    found += [Pair(str(seed), str(other), data, plates=False) for seed, other in shifted]
    return found[::10] if quick else found


def accused(pair: Pair) -> Accused:
    """Reconstructs and judges a trial with a subject file.

    Args:
        pair: Both.
    """
    with single_threaded():
        capture, subject = pair.load()
        settings = ReconstructSettings(filter="dynamic" if capture.plates else "kinematic")
        try:
            found = reconstruct(capture, subject, settings=settings)
        except MbkfError as error:
            return Accused(pair, "refused", float("nan"), str(error))
    verdict = verdict_of(found)
    powers = next((one.value for one in found.checks if one.name == NAME), None)
    return Accused(pair, verdict.overall, float("nan") if powers is None else powers, verdict.line)


def person_rows(found: Sequence[Accused]) -> Iterator[Check]:
    """Rows of wrong persons that are reported, and of right ones that are accused.

    Args:
        found: The pairs.
    """
    for title, chosen in (
        ("public, with plates", [a for a in found if not _made(a) and a.pair.plates and not a.pair.own]),
        ("public, markers alone", [a for a in found if not _made(a) and not a.pair.plates]),
        ("synthetic, markers alone, shown on", [a for a in found if _made(a) and not a.pair.own]),
    ):
        missed = [a for a in chosen if a.word == "use"]
        for one in missed:
            label = f"{one.pair.trial} with the file of {one.pair.file}"
            yield information(f"wrong person, {title}: {label}: use, powers of ten", one.powers)
        share = 100.0 * (1.0 - len(missed) / max(len(chosen), 1))
        yield Check(
            f"wrong persons reported ({title}, {len(chosen)} pairs)", share, LEAST_REPORTED, ">=", "%"
        )
    for title, right in (
        ("public", [a for a in found if a.pair.own and not _made(a)]),
        ("synthetic, shown on", [a for a in found if a.pair.own and _made(a)]),
    ):
        wrongly = [a for a in right if a.powers >= LOOK or a.word == "refused"]
        for one in wrongly:
            yield information(
                f"right person accused: {one.pair.trial}: {one.line}, powers of ten", one.powers
            )
        yield Check(f"right persons accused ({title}, {len(right)} trials)", len(wrongly), 0, "<=", "")


def _made(one: Accused) -> bool:
    return one.pair.trial.isdecimal()
