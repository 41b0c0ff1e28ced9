"""Sets of persons whose rows are shown together: the shared ones, and those of our own under each skin model."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from benchmarks.checks import Check, Context, information
from benchmarks.dynamic.methods import Mapper
from benchmarks.foreign.errors import Judged
from benchmarks.foreign.followed import SMOOTHED, followed, jobs
from benchmarks.foreign.making import make
from benchmarks.foreign.making.persons import CHOSEN_ON, SHOWN_ON
from benchmarks.foreign.making.skin import MODELS
from benchmarks.foreign.truth import FOLDER, Foreigner, foreigners
from mbkf.errors import MissingDependency

MARK = "made_by.txt"
"""In a folder of made persons: a digest of the sources that made them, and the seed."""


@dataclass(frozen=True)
class PersonSet:
    """Persons whose rows are shown together.

    Attributes:
        name: Name of the set.
        persons: The persons.
        shown: True where no setting was chosen on them.
        own: True where we made them.
    """

    name: str
    persons: tuple[Foreigner, ...]
    shown: bool
    own: bool

    def found(self, scaling: str, mapper: Mapper, filter: str = SMOOTHED) -> list[Judged]:
        """Errors of all motions.

        Args:
            scaling: Motions that persons are scaled from.
            mapper: Runs the jobs.
            filter: "smoothed" or "causal".
        """
        return [one for held in mapper(followed, jobs(self.persons, scaling, (), filter)) for one in held]


def shared_set(data: Path) -> PersonSet:
    """The shared persons.

    Args:
        data: Folder of the reference captures.
    """
    persons = tuple(foreigners(data / FOLDER))
    return PersonSet(" and ".join(one.name for one in persons), persons, shown=False, own=False)


def own_sets(folder: Path) -> Iterator[PersonSet]:
    """Persons of our own under each skin model: those that settings may be chosen on, and those shown.

    Args:
        folder: Where they were made.
    """
    for model in MODELS:
        for kind, names in (("chosen on", CHOSEN_ON), ("shown", SHOWN_ON)):
            persons = tuple(foreigners(folder / model, names))
            yield PersonSet(f"own persons {kind}, {model}", persons, shown=kind == "shown", own=True)


def made_persons(data: Path, folder: Path, seed: int) -> Path:
    """The folder with persons of our own, who are made where these sources and this seed have not made them before.

    Args:
        data: Folder of the reference captures.
        folder: The folder.
        seed: Chooses skin, misplacement, noise and gaps.

    Raises:
        MissingDependency: OpenSim is not installed.
    """
    mark, wanted = folder / MARK, f"{digest()} {seed}\n"
    if not mark.is_file() or mark.read_text(encoding="utf-8") != wanted:
        make(data, folder, seed)
        mark.write_text(wanted, encoding="utf-8")
    return folder


def made_or_left_out(context: Context) -> tuple[Path | None, list[Check]]:
    """The folder with persons of our own in the output folder; None where OpenSim is missing, with a row, and if quick.

    Args:
        context: Where data are, where files go, and the seed.
    """
    if context.quick:
        return None, []
    try:
        return made_persons(context.require_data(), context.out / "persons", context.seed), []
    except MissingDependency as missing:
        return None, [information(f"persons of our own are left out: {missing}", float("nan"))]


def digest() -> str:
    """Digest of the sources that make persons."""
    found = hashlib.sha256()
    for path in sorted((Path(__file__).parent / "making").glob("*.*")):
        if path.suffix in {".py", ".toml"}:
            found.update(path.read_bytes())
    return found.hexdigest()
