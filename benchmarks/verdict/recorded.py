"""Recorded trials that faults are put into: person, standing trial, a short capture, and the right results."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.dynamic.captures import Source
from benchmarks.dynamic.methods import tared
from benchmarks.foreign.followed import SCALINGS
from benchmarks.foreign.truth import FOLDER, Foreigner
from benchmarks.loads.trials import ALL_SOURCES
from benchmarks.verdict.errors import ANGLES, Right, right_of
from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.synthesis.anatomy import true_angles
from mbkf.trial.preparation.selection import subject_markers
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale
from mbkf.trial.synth import synthesise

LASTS_S = 1.8
"""Trials are cut to this: the stretch in which plates bear the person for longest."""

BEARS = 0.5
"""Share of body weight from which plates bear the person."""


@dataclass(frozen=True)
class Thrown:
    """A limb that the filter is thrown into a wrong pose of.

    Attributes:
        kind: One of :data:`benchmarks.limbs.faults.POSES`.
        limb: Name of the limb.
        frame: The frame.
    """

    kind: str
    limb: str
    frame: int


@dataclass(frozen=True)
class Recorded:
    """A trial as a laboratory records it.

    Attributes:
        static: The standing trial; None where the person is scaled from the capture.
        capture: Markers under the subject's names, and plates.
        subject: The person.
        trials: Trials that the person is scaled from besides.
        scale_again: True where a fault concerns the standing trial, so that the person has to be scaled from it.
        thrown: A fault of the filter's pose.
    """

    static: Capture | None
    capture: Capture
    subject: Subject
    trials: tuple[Capture, ...] = ()
    scale_again: bool = False
    thrown: Thrown | None = None

    def person(self) -> Subject:
        """The person whom a laboratory would follow."""
        if not self.scale_again:
            return self.subject
        return scale(self.static, [self.capture] if self.static is None else [], mass_kg=self.subject.mass_kg)


@dataclass(frozen=True)
class Base:
    """A trial without a fault.

    Attributes:
        kind: "own", "foreign" or "real".
        name: The motion, or a key of :data:`benchmarks.loads.trials.ALL_SOURCES`.
        data: Folder of the reference captures.
        who: The seed of an own trial, or the folder's name of a foreign person.
        chosen: True where bounds may be set on it.
    """

    kind: str
    name: str
    data: Path
    who: str = ""
    chosen: bool = True

    @property
    def label(self) -> str:
        """Its name in rows."""
        return f"{self.name} {self.who}".strip()


CHOSEN: tuple[tuple[str, str, str], ...] = (
    ("own", "walk", "20"),
    ("own", "squat", "21"),
    ("own", "jump", "22"),
    ("own", "turn", "23"),
    ("foreign", "walk", "adult"),
    ("foreign", "squat", "adult"),
    ("foreign", "run", "adult"),
    ("real", "rajagopal walk", ""),
    ("real", "gait2354", ""),
    ("real", "rehazenter", ""),
)
SHOWN: tuple[tuple[str, str, str], ...] = (
    ("own", "walk", "30"),
    ("own", "squat", "31"),
    ("own", "step_up", "32"),
    ("own", "turn", "33"),
    ("foreign", "walk", "child"),
    ("foreign", "squat", "child"),
    ("foreign", "run", "child"),
    ("real", "rajagopal run", ""),
    ("real", "biomechzoo HC032A", ""),
    ("real", "biomechzoo HC044A", ""),
)


def bases(data: Path) -> list[Base]:
    """The trials without a fault: persons on whom bounds may be set, then others.

    Args:
        data: Folder of the reference captures.
    """
    return [
        Base(kind, name, data, who, chosen)
        for of, chosen in ((CHOSEN, True), (SHOWN, False))
        for kind, name, who in of
    ]


@cache
def load(base: Base) -> tuple[Recorded, Right]:
    """The trial and its right results: the truth of persons made, and of public captures the result without a fault.

    Args:
        base: The trial.
    """
    if base.kind == "own":
        return _own(base)
    if base.kind == "foreign":
        return _foreign(base)
    recorded = real(ALL_SOURCES[base.name], base.data)
    return recorded, right_of(reconstruct(recorded.capture, recorded.subject))


def real(source: Source, data: Path) -> Recorded:
    """A public capture.

    Args:
        source: Where it lies.
        data: Folder of the reference captures.
    """
    folder = data / source.folder
    capture = read_capture(folder / source.trial, forces=source.forces and folder / source.forces)
    static = None if source.static is None else read_capture(folder / source.static)
    trials = (capture,) if static is None else ()
    subject = scale(static, trials, mass_kg=source.mass_kg)
    return cut(named(static, capture, subject, trials))


def _own(base: Base) -> tuple[Recorded, Right]:
    person, made = synthesise(base.name, seed=int(base.who))
    subject = scale(made.static, mass_kg=person.mass_kg, protocol=person.protocol)
    recorded = cut(named(made.static, tared(made.trial), subject))
    truth, clinical = made.truth, ClinicalAngles(HumanModel.of(person))
    angles = true_angles(person, truth.q)
    moments = clinical.moments(truth.q, truth.tau, clinical.angles(truth.q)) / person.mass_kg
    frames = np.searchsorted(truth.times_s, recorded.capture.markers.times_s - 1e-6)
    column = {name: clinical.names.index(name) for name in ANGLES}
    return recorded, Right(
        {name: angles[frames, at] for name, at in column.items()},
        {name: moments[frames, at] for name, at in column.items()},
    )


def _foreign(base: Base) -> tuple[Recorded, Right]:
    person = Foreigner(base.who, base.data / FOLDER / base.who)
    static, truth = person.static(), person.truth(base.name)
    trials = tuple(person.trial(name) for name in SCALINGS["session"])
    subject = scale(static, trials, mass_kg=person.mass_kg)
    recorded = cut(named(static, person.trial(base.name), subject, trials))
    times = recorded.capture.markers.times_s

    def at(values: Array) -> Array:
        return np.asarray(np.interp(times, truth.times_s, values))

    return recorded, Right(
        {name: at(truth.coordinate(name)) for name in ANGLES},
        {name: at(truth.moment(name)) / truth.mass_kg for name in ANGLES},
    )


def named(
    static: Capture | None, capture: Capture, subject: Subject, trials: Sequence[Capture] = ()
) -> Recorded:
    """A trial whose captures have the subject's markers, under the subject's names.

    Args:
        static: The standing trial.
        capture: The trial.
        subject: The person.
        trials: Trials that the person was scaled from besides.
    """

    def own(one: Capture) -> Capture:
        return replace(one, markers=subject_markers(one.markers, subject))

    standing = None if static is None else own(static)
    return Recorded(standing, own(capture), subject, tuple(own(one) for one in trials))


def cut(whole: Recorded) -> Recorded:
    """The stretch in which plates bear the person for longest; plates stay whole."""
    markers, weight_n = whole.capture.markers, whole.subject.mass_kg * GRAVITY_M_S2
    frames = min(markers.frames, round(LASTS_S * markers.rate_hz))
    read = np.zeros(markers.frames)
    for plate in whole.capture.plates:
        read += np.interp(markers.times_s, plate.times_s, np.nan_to_num(plate.force_n[:, 2]), 0.0, 0.0)
    bears = np.concatenate([[0], np.cumsum(read > BEARS * weight_n)])
    first = int(np.argmax(bears[frames:] - bears[: len(bears) - frames]))
    cut = replace(
        markers,
        positions_m=markers.positions_m[first : first + frames],
        start_time_s=float(markers.times_s[first]),
    )
    return replace(whole, capture=replace(whole.capture, markers=cut))
