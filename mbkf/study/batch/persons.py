"""Persons whose captures lie in one folder, separated by subjects that files name, by codes in file names, by size.

- Names of subjects (C3D SUBJECTS:NAMES) count where they can be persons: each has a standing trial or stands in the
  names of its files, or all are codes of one form. Some systems write a marker set's name there, another one for
  standing than for moving.
- A file name's first word, else its last one, counts where it is a code (P01_walk, HC032A_static) or a word that
  standing and moving trials share (anna_static, anna_walk).
- Stated masses or heights that differ are those of different persons, whatever their names.

Captures that none of these separates stay together; movements may separate them (:mod:`mbkf.study.batch.sorting`).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from mbkf.io.c3d_person import StatedPerson

MASS_SHARE, HEIGHT_M = 0.03, 0.02
"""Differences of stated masses and heights beyond which they are another person's. A person's files of one session
state one value; some of them are rounded to a kilogram or centimetre."""

PERSON_WORDS = frozenset(
    (
        "hc",
        "id",
        "p",
        "pat",
        "patient",
        "participant",
        "pp",
        "proband",
        "pt",
        "s",
        "sub",
        "subj",
        "subject",
        "sujet",
        "vp",
    )
)
"""Letters of codes that are persons' also where no standing trial carries one."""

TASKS = re.compile(
    r"(?i)(walk|run|gait|march|gang|trial|take|cond|jump|squat|test|task|rep|set|day|visit|session|speed|sprint|land|hop"
    r"|lunge|stair|step(?!h)|turn|sit|stand|stat|cal|dyn|mov|motion|rec|capture|func|reach|lift|ex|left|right|slow|fast|pre"
    r"|post|raw|filt|smooth|proc|edit|barefoot|shod|norm|neutral|pose|t$|l$|r$)"
)
"""Beginnings of words that name a task, a condition or a repetition."""

CODE = re.compile(r"([^\W\d_]*)(\d+)[^\W\d_]?")
"""A person's code: letters, digits and at most one letter."""

LONG_NUMBER, SHORTEST_WORD = 5, 3
"""Digits from which a number without letters can be a code, and letters from which a word can be a name."""


@dataclass(frozen=True)
class PersonFiles:
    """Captures of one person in a folder.

    Attributes:
        label: The person's name or code; the stated mass where the files have neither; "" for a folder of one person.
        captures: The captures.
        mass_kg: Body mass that they state; None where they do not.
        height_m: Body height that they state; None where they do not.
    """

    label: str
    captures: tuple[Path, ...]
    mass_kg: float | None = None
    height_m: float | None = None


@dataclass(frozen=True)
class FolderPersons:
    """Persons of a folder.

    Attributes:
        persons: One for each, or one of an empty label where nothing tells captures apart.
        unknown: Captures of a folder of several persons that could be of any of them.
        subjects: Names of subjects in files of a folder whose captures nothing tells apart, where they differ.
    """

    persons: tuple[PersonFiles, ...]
    unknown: tuple[Path, ...] = ()
    subjects: tuple[str, ...] = ()


def persons_of_files(
    captures: Sequence[Path],
    statics: Collection[Path],
    stated: Callable[[Path], StatedPerson],
) -> FolderPersons:
    """The persons whose captures lie in a folder.

    Args:
        captures: The captures.
        statics: The standing trials among them.
        stated: Reads the statements of a capture about its person.
    """
    facts = {path: stated(path) for path in captures}
    labels = _by_names(facts, statics) or _by_words(captures, statics) or dict.fromkeys(captures, "")
    known = list(dict.fromkeys(labels.values()))
    persons, unknown = [], [path for path in captures if path not in labels]
    for label in known:
        own = [path for path in captures if labels.get(path) == label]
        groups, rest = _by_size(label, own, facts)
        persons += groups
        unknown += rest
    names = {_plain(one.names[0]): one.names[0] for one in facts.values() if len(one.names) == 1}
    subjects = tuple(names.values()) if len(persons) == 1 and len(names) > 1 else ()
    return FolderPersons(tuple(persons), tuple(unknown), subjects)


def _by_names(facts: Mapping[Path, StatedPerson], statics: Collection[Path]) -> dict[Path, str]:
    """The captures' labels by the subjects that files name; empty where these are one person's or a marker set's."""
    single = {path: one.names[0] for path, one in facts.items() if len(one.names) == 1}
    plain = {path: _plain(name) for path, name in single.items()}
    first = {plain[path]: name for path, name in reversed(single.items())}
    if len(first) < 2:
        return {}
    standing = {plain[path] for path in statics if path in plain}
    in_stems = {name for path, name in plain.items() if name and name in _plain(path.stem)}
    if not (set(first) <= standing | in_stems or _are_codes(tuple(first))):
        return {}
    labels = {path: first[name] for path, name in plain.items()}
    for path in facts:  # a file that names no subject, but carries the name of one in its own
        owners = {name for name in first if path not in labels and name in _plain(path.stem)}
        if len(owners) == 1:
            labels[path] = first[owners.pop()]
    return labels


def _are_codes(names: Sequence[str]) -> bool:
    """True for names that are codes of one form, such as P01 and P02."""
    matches = [CODE.fullmatch(name) for name in names]
    forms = {match[1] if match else "" for match in matches}
    return len(forms) == 1 and forms != {""} and not any(TASKS.match(name) for name in names)


def _plain(name: str) -> str:
    return "".join(re.findall(r"[^\W_]+", name.casefold()))


def _by_words(captures: Sequence[Path], statics: Collection[Path]) -> dict[Path, str]:
    """The captures' labels by codes or words in their names; empty where these do not tell persons apart."""
    for cut in (r"[\W_]+", r"[\W_]+|(?<=\d)(?=[^\W\d_]{2})"):
        for place in (0, -1):
            words = {}
            for path in captures:
                parts = [part for part in re.split(cut, path.stem) if part]
                if len(parts) > 1:
                    words[path] = parts[place]
            found = _codes(words, captures, statics) or _shared_words(words, captures, statics)
            if len({word.casefold() for word in found.values()}) > 1:
                first = {word.casefold(): word for word in reversed(found.values())}
                return {path: first[word.casefold()] for path, word in found.items()}
    return {}


def _codes(words: Mapping[Path, str], captures: Sequence[Path], statics: Collection[Path]) -> dict[Path, str]:
    """Words that are codes of one form; not every capture needs one where several standing trials carry codes.

    Codes with other letters than those of persons that all differ are numbers of trials.
    """
    found, forms = {}, set()
    for path, word in words.items():
        match = CODE.fullmatch(word)
        if match is None or TASKS.match(word) or (not match[1] and len(match[2]) < LONG_NUMBER):
            continue
        found[path] = word
        forms.add(match[1].casefold())
    if len(forms) != 1:
        return {}
    standing = {found[path].casefold() for path in statics if path in found}
    every = {word.casefold() for word in found.values()}
    if len(found) < len(captures) and len(standing) < 2:
        return {}
    is_person = forms <= PERSON_WORDS or (bool(standing) and len(every) < len(found))
    if forms == {""}:  # a number may be a date or time as well
        is_person = standing == every
    return found if is_person else {}


def _shared_words(
    words: Mapping[Path, str], captures: Sequence[Path], statics: Collection[Path]
) -> dict[Path, str]:
    """Words, each in a standing and in a moving trial; empty unless all captures have one."""
    plain = {path: word.casefold() for path, word in words.items() if _can_name(word)}
    if len(plain) < len(captures):
        return {}
    standing = {plain[path] for path in statics}
    moving = {plain[path] for path in captures if path not in statics}
    return dict(words) if standing == moving else {}


def _can_name(word: str) -> bool:
    shortest = LONG_NUMBER if word.isdecimal() else SHORTEST_WORD
    return len(word) >= shortest and not TASKS.match(word)


def _by_size(
    label: str, captures: Sequence[Path], facts: Mapping[Path, StatedPerson]
) -> tuple[list[PersonFiles], list[Path]]:
    """The persons among captures of one label by mass and height, and captures that could be of any of them."""
    groups: list[list[Path]] = []
    silent = []
    for path in captures:
        if facts[path].mass_kg is None and facts[path].height_m is None:
            silent.append(path)
            continue
        own = next((one for one in groups if all(_alike(facts[path], facts[o]) for o in one)), None)
        if own is None:
            groups.append([path])
        else:
            own.append(path)
    if len(groups) < 2:
        one = next((facts[path] for path in captures if path not in silent), StatedPerson())
        return [PersonFiles(label, tuple(captures), one.mass_kg, one.height_m)], []
    found = [(tuple(group), facts[group[0]]) for group in groups]
    sizes = [_size(one) for _, one in found]
    names = [f"{size}_{k + 1}" if sizes.count(size) > 1 else size for k, size in enumerate(sizes)]
    return [
        PersonFiles(f"{label}_{name}" if label else name, group, one.mass_kg, one.height_m)
        for name, (group, one) in zip(names, found, strict=True)
    ], silent


def _alike(one: StatedPerson, other: StatedPerson) -> bool:
    """False where two files state masses or heights of different persons."""
    masses = [m for m in (one.mass_kg, other.mass_kg) if m is not None]
    heights = [h for h in (one.height_m, other.height_m) if h is not None]
    same_mass = len(masses) < 2 or abs(masses[0] - masses[1]) <= MASS_SHARE * max(masses)
    return same_mass and (len(heights) < 2 or abs(heights[0] - heights[1]) <= HEIGHT_M)


def _size(one: StatedPerson) -> str:
    mass = "" if one.mass_kg is None else f"{one.mass_kg:.1f}kg"
    height = "" if one.height_m is None else f"{one.height_m:.2f}m"
    return "_".join(part for part in (mass, height) if part)
