"""Mistakes that people make in files that they edit by hand: each is refused by name, or read as it was meant.

``mistakes.toml`` lists them. A mistake counts as ignored where the file is read without a word and without its meaning,
and as spread where it costs another person of a study more than itself.
"""

from __future__ import annotations

import tomllib
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, Context
from mbkf.conventions import data_folder
from mbkf.errors import MbkfError
from mbkf.io.imu.mount import ImuMount, read_mounts, write_mounts
from mbkf.io.norms import POINTS, Band, Norms, read_norms, write_norms
from mbkf.io.subject import Subject, SubjectMarker, read_subject, write_subject
from mbkf.model.body_file import load_body
from mbkf.model.human import HumanModel
from mbkf.model.protocol import load_protocol
from mbkf.study.batch.plan import Plan
from mbkf.study.batch.run import plan_of
from mbkf.trial.preparation.presets import with_preset
from mbkf.trial.preparation.settings import ReconstructSettings

MISTAKES = Path(__file__).with_name("mistakes.toml")
BOUND = 120
"""Least number of mistakes."""

SESSION = (
    'name = "P01"\nmass_kg = 71.2\nheight_m = 1.78\nsex = "female"\nage = 34\nprotocol = "plug_in_gait"\n'
    '[trial.w3]\nexcluded = "fell"\n'
)
CSV = "subject,trial,static,mass_kg,height_m\nP01,w1.c3d,s.c3d,71.2,1.78\nP09,w9.c3d,,80,\n"
TOML = (
    '[[subject]]\nname = "P01"\nmass_kg = 71.2\nstatic = "s.c3d"\ntrials = ["w1.c3d"]\n'
    '[[subject]]\nname = "P09"\ntrials = ["w9.c3d"]\n'
)
PRESET = 'name = "own"\nfilter = "dynamic"\n[values]\ngate = 5.0\n'
PROTOCOL = 'name = "mine"\n[[marker]]\nname = "A"\nlandmark = "c7"\nnoise_mm = 5\n'


@dataclass(frozen=True)
class Mistake:
    """An edit and its right end.

    Attributes:
        file: Kind of the file.
        old, new: Text of the sample, and the person's text in its place.
        refused: Words that the message must have; empty for a text that is to be read.
        read: Values as they are meant; empty for a text that is to be refused.
        lost: Person of a study who pays for it: ``"*"`` where all may, empty where the list is refused as a whole.
        encoding, ends: Of the file.
    """

    file: str
    old: str
    new: str
    refused: tuple[str, ...] = ()
    read: str = ""
    lost: str | None = None
    encoding: str = "utf-8"
    ends: str = "\n"


@dataclass(frozen=True)
class End:
    """The end of a mistake: "right", or the fault, and the message or values found."""

    verdict: str
    found: str


def rows(context: Context) -> list[Check]:
    """Counts of mistakes, and of those that are ignored, refused without the right words, or costly to others."""
    ends = [(mistake, end_of(mistake, context.out / f"{n}")) for n, mistake in enumerate(mistakes())]
    for mistake, end in ends:
        if end.verdict != "right":
            print(f"{end.verdict}: {mistake.file} {mistake.new!r}: {end.found}")
    counts = Counter(end.verdict for _, end in ends)
    return [
        Check("mistakes of people in files", float(len(ends)), float(BOUND), ">="),
        *(Check(f"mistakes {verdict}", float(counts[verdict]), 0.0, "<=") for verdict in VERDICTS),
    ]


VERDICTS = ("ignored", "misread", "without the right words", "spread", "unforeseen")
"""Wrong ends."""


def mistakes() -> list[Mistake]:
    """The mistakes of ``mistakes.toml``."""
    listed = tomllib.loads(MISTAKES.read_text(encoding="utf-8"))["mistake"]
    return [Mistake(**{**one, "refused": tuple(one.get("refused", ()))}) for one in listed]


def end_of(mistake: Mistake, folder: Path) -> End:
    """Makes the mistake in a sample file and reads it.

    Args:
        mistake: The mistake.
        folder: A new folder for the file.
    """
    sample, name, read = samples()[mistake.file]
    if mistake.old not in sample:
        return End("unforeseen", f"'{mistake.old}' does not stand in the sample")
    folder.mkdir(parents=True)
    text = sample.replace(mistake.old, mistake.new, 1).replace("\n", mistake.ends)
    (folder / name).write_bytes(text.encode(mistake.encoding))
    try:
        found = read(folder / name)
    except MbkfError as error:
        return _refusal(mistake, str(error))
    except Exception as error:  # a bug of mbkf, which is a result of this benchmark
        return End("unforeseen", f"{type(error).__name__}: {error}")
    if isinstance(found, Plan):
        return _plan_end(mistake, found)
    return _reading(mistake, str(found))


def _refusal(mistake: Mistake, message: str) -> End:
    if not mistake.refused:
        return End("misread", message)
    wanting = [word for word in mistake.refused if word not in message]
    return (
        End("without the right words", f"{message} (without {wanting})") if wanting else End("right", message)
    )


def _reading(mistake: Mistake, found: str) -> End:
    if mistake.refused:
        return End("ignored", found)
    return End("right" if mistake.read == found else "misread", found)


def _plan_end(mistake: Mistake, plan: Plan) -> End:
    """The end of a study: the fault of the person who pays, or the values of the plan."""
    faults = {one.fault for one in plan.trials if one.fault}
    if not faults:
        remarked = " ".join(plan.notes)
        if mistake.refused:
            return _refusal(mistake, remarked) if remarked else End("ignored", values_of(plan))
        return _reading(mistake, values_of(plan))
    others = [one.person.name for one in plan.trials if one.fault and one.person.name == "P09"]
    if others and mistake.lost != "*":
        return End("spread", f"P09 has the fault {faults}")
    return _refusal(mistake, " ".join(sorted(faults)))


def values_of(plan: Plan) -> str:
    """The stated values of a plan's first person, and whether there was a remark."""
    person = plan.trials[0].person
    remark = " with a remark" if plan.notes else ""
    if person.protocol is not None:
        return f"mass_kg={person.mass_kg}"
    return f"{person.name}:{person.mass_kg},{person.height_m}{remark}"


@cache
def samples() -> Mapping[str, tuple[str, str, Callable[[Path], object]]]:
    """Sample text, file name and reader of each kind of file."""
    return {
        "session": (SESSION, "session.toml", _session_plan),
        "subject": (
            _written(_write_subject),
            "subject.toml",
            lambda path: HumanModel.of(read_subject(path)).mass_kg,
        ),
        "list.csv": (CSV, "list.csv", plan_of),
        "list.toml": (TOML, "list.toml", plan_of),
        "preset": (PRESET, "own.toml", lambda path: with_preset(ReconstructSettings(), str(path)).filter),
        "norms": (_written(_write_norms), "norms.toml", read_norms),
        "mounts": (_written(_write_mounts), "mounts.toml", read_mounts),
        "protocol": (PROTOCOL, "mine.toml", load_protocol),
        "body": (
            (data_folder("models") / "human18.toml").read_text(encoding="utf-8"),
            "mine.toml",
            load_body,
        ),
    }


def _session_plan(path: Path) -> Plan:
    for name in ("w1", "w2", "w3"):
        (path.parent / f"{name}.c3d").touch()
    return plan_of(path.parent)


def _written(write: Callable[[Path], None]) -> str:
    from tempfile import TemporaryDirectory

    with TemporaryDirectory() as folder:
        path = Path(folder) / "sample.toml"
        write(path)
        return path.read_text(encoding="utf-8")


def _write_subject(path: Path) -> None:
    factors = {**dict.fromkeys(load_body().scale_factors, 1.0), "right_thigh": 1.01}
    marker = SubjectMarker("RKNE", "right_thigh", np.array([0.01, -0.05, -0.4]), 0.005, 0.005)
    write_subject(Subject("human18", 70.0, factors, (marker,), "reference36"), path)


def _write_norms(path: Path) -> None:
    curve = Band("deg", 3, np.full(POINTS, 0.5), np.full(POINTS, 0.25))
    speed = Band("m/s", 3, np.array([1.25]), np.array([0.1]))
    write_norms(Norms("ours", {("walk", "angle", "knee_angle"): curve}, {("walk", "Speed"): speed}), path)


def _write_mounts(path: Path) -> None:
    write_mounts([ImuMount("A", "pelvis", np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]))], path)
