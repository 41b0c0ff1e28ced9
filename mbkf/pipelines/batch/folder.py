"""A folder of captures understood: a folder with captures is a session, the first folder on the way to it a person.

    study/P01/static.c3d, study/P01/walk1.c3d                  person P01
    study/P01/monday/static.c3d, study/P01/monday/walk1.trc    person P01, session monday

Standing trials are known by their names; where none is, by standing still. Ground reactions lie beside their trial,
under its name with ``grf`` or ``forces``. ``session.toml`` in a session's folder, or above it, states mass, height and
protocol.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.io.capture import CAPTURES, FORCES
from mbkf.io.plain_data import read_toml
from mbkf.pipelines.batch.plan import MOST_LOOKED_AT, MOST_MOVING, Files, Person, Plan, Trial, planned

CAPTURE_SUFFIXES = (".c3d", ".trc")
"""Captures of a folder, the more telling first; other formats are named in a list."""

SESSION_FILE = "session.toml"
SUBJECT_FILE = "subject.toml"
"""A person scaled before, in the session's folder."""

STATIC = re.compile(
    r"(^|[^a-z])(static|statique|statisch|estatica|estatico|standing|stand|calib(ration)?|cal|[tna]-?_?pose|neutral)"
    r"([^a-z]|$)"
)
"""Names of standing trials, in lower case."""

STATED = ("mass_kg", "height_m", "protocol")
"""What a session file states of the person."""


@dataclass(frozen=True)
class _Stated:
    """What session files state."""

    mass_kg: float | None = None
    height_m: float | None = None
    protocol: str | None = None


def plan_of_folder(folder: Path) -> Plan:
    """The persons and trials of a folder.

    Raises:
        FileFormatError: A session file is damaged.
        InvalidInput: It holds no trial.
    """
    root = folder.absolute()
    trials: list[Trial] = []
    for place, captures in _sessions(root):
        trials += _trials(root, place, captures)
    return planned(trials, str(folder))


def is_static(path: Path) -> bool:
    """Whether a capture's name is that of a standing trial."""
    return STATIC.search(path.stem.lower()) is not None


def forces_beside(path: Path, files: Sequence[Path]) -> Path | None:
    """The file of ground reactions that belongs to a capture: its own name with ``grf`` or ``forces``, or its suffix.

    Args:
        path: The capture.
        files: The files of its folder.
    """
    own = _essence(path.stem)
    for file in files:
        name = file.stem.lower()
        if file == path or file.suffix.lower() not in FORCES.suffixes:
            continue
        named = file.suffix.lower() not in CAPTURES.suffixes or "grf" in name or "force" in name
        if named and (name == path.stem.lower() or _essence(name) == own) and not _is_other(file):
            return file
    return None


def _essence(stem: str) -> str:
    """A name without what tells markers and ground reactions apart."""
    words = re.split(r"[_\-. ]+", stem.lower())
    return "_".join(
        w
        for w in words
        if w not in {"grf", "grfs", "force", "forces", "markers", "marker", "motion", "capture"}
    )


def _is_other(file: Path) -> bool:
    """Whether a motion file holds coordinates or moments, as OpenSim's tools write them, and no forces."""
    return file.suffix.lower() in {".mot", ".sto"} and not re.search(r"grf|force", file.stem.lower())


def _sessions(root: Path) -> Iterator[tuple[Path, list[Path]]]:
    """Folders with captures, and these."""
    for place in sorted({path.parent for suffix in CAPTURE_SUFFIXES for path in _found(root, suffix)}):
        by_stem: dict[str, Path] = {}
        for suffix in reversed(CAPTURE_SUFFIXES):
            by_stem.update({path.stem.lower(): path for path in _found(root, suffix) if path.parent == place})
        yield place, [by_stem[stem] for stem in sorted(by_stem)]


def _found(root: Path, suffix: str) -> Iterator[Path]:
    """Files with a suffix, hidden ones left out."""
    for path in sorted(root.rglob("*")):
        hidden = any(part.startswith(".") for part in path.relative_to(root).parts)
        if path.suffix.lower() == suffix and path.is_file() and not hidden:
            yield path


def _trials(root: Path, place: Path, captures: Sequence[Path]) -> list[Trial]:
    """The trials of one session."""
    parts = place.relative_to(root).parts
    stated, files = _stated(root, place), sorted(place.iterdir())
    statics = tuple(path for path in captures if is_static(path))
    moving = [Files(path, forces_beside(path, files)) for path in captures if path not in statics]
    subject = place / SUBJECT_FILE
    person = Person(
        parts[0] if parts else root.name,
        "-".join(parts[1:]),
        statics,
        tuple(moving[: MOST_MOVING if statics else MOST_LOOKED_AT]),
        stated.mass_kg,
        stated.height_m,
        stated.protocol,
        subject if subject.is_file() else None,
    )
    return [Trial(person, one.path, one.forces, one.path.stem) for one in moving]


def _stated(root: Path, place: Path) -> _Stated:
    """What session files say, the nearest last.

    Raises:
        FileFormatError: One is damaged, or says something else.
    """
    found: dict[str, float | str] = {}
    for folder in reversed([place, *(p for p in place.parents if p == root or root in p.parents)]):
        file = folder / SESSION_FILE
        if file.is_file():
            found |= _read(file)
    return _Stated(**found)  # type: ignore[arg-type]


def _read(file: Path) -> Mapping[str, float | str]:
    try:
        stated = read_toml(file)
    except (OSError, ValueError) as error:
        raise FileFormatError(file, f"is no session file ({error})") from error
    return {key: checked_entry(key, stated[key], file) for key in STATED if key in stated}


def checked_entry(key: str, value: object, file: Path, line: int | None = None) -> float | str:
    """A mass, height or protocol as it must be.

    Args:
        key: One of :data:`STATED`.
        value: What the file says.
        file: The file.
        line: Its line, None where it is not known.

    Raises:
        FileFormatError: It is not one.
    """
    if key == "protocol":
        if isinstance(value, str) and value:
            return value
        raise FileFormatError(file, "protocol must be a name or a file", line)
    low, high = {"mass_kg": (0.5, 500.0), "height_m": (0.3, 2.8)}[key]
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise FileFormatError(file, f"{key} must be a number between {low:g} and {high:g}, got {value}", line)
    return float(value)
