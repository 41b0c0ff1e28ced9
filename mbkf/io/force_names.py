"""Names of force columns: which plate or foot, which quantity and which axis each column of a table holds.

A name is cut into words; every word is a quantity, an axis, both, filling, or part of the name of the plate or
foot. Whatever their order, these all say the same of a set called 1::

    ground_force_1_vx   1_ground_force_vx   ground_force1_vx   force1_vx   FP1.ForX   Fx1   F1x   f1_1
    ground_force_1_px   1_ground_force_px   cop_1_x   Cop1x   X1   p1_1
    ground_torque_1_x   1_ground_torque_x   ground_force_1_mx   ground_moment_1_x   Moment.Mx1   m1_1

Of several quantities in one name the last one holds: ``ground_force_1_mx`` is a moment.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from mbkf.errors import FileFormatError, UnknownName

Quantity = Literal["force", "point", "moment"]

UNNAMED_SET = "0"
"""Name of the set whose columns carry none; ``1_ground_force_vx`` is then the next."""

_AXES = "xyz"
_WORDS: dict[str, Quantity] = {
    "force": "force", "forces": "force", "grf": "force", "for": "force",
    "point": "point", "cop": "point", "pressure": "point",
    "moment": "moment", "moments": "moment", "mom": "moment", "torque": "moment", "torques": "moment",
    "grm": "moment",
}  # fmt: skip
_LETTERS: dict[str, Quantity] = {
    "f": "force", "v": "force", "p": "point", "c": "point", "m": "moment", "t": "moment",
}  # fmt: skip
_ALONE = frozenset("fvpm")
"""Letters that stand for a quantity without an axis beside them; c and t might be anything."""
_FILLING = (
    "ground", "reaction", "forceplate", "plate", "platform", "center", "centre", "of", "application", "free",
)  # fmt: skip
_ONLY_FILLING = frozenset({"fp", "fplate"})
_ALTERNATIVES = "|".join(sorted([*_WORDS, *_FILLING], key=len, reverse=True))
_WORD = re.compile(
    rf"(?P<side>left|right|l|r)?(?P<words>(?:{_ALTERNATIVES})*)"
    r"(?:(?P<letter>[fvpcmt])?(?P<axis>[xyz])(?P<after>left|right|l|r)?)?"
)
_PART = re.compile(_ALTERNATIVES)
_BRACKETS = re.compile(r"\([^)]*\)|\[[^\]]*\]")
_CHUNKS = re.compile(r"[a-z]+|\d+")


@dataclass(frozen=True)
class ForceColumn:
    """Meaning of a column's name.

    Attributes:
        set_name: Words that name the plate or foot, lower case, joined by "_"; "" where there are none.
        quantity: Force, point of application or moment; None where the name has an axis only.
        axis: 0, 1, 2 for x, y, z.
        place: Index of the axis's character in the name.
    """

    set_name: str
    quantity: Quantity | None
    axis: int
    place: int


@dataclass(frozen=True)
class ForceSet:
    """Columns of one plate or foot; each entry is the index of a column, None without a such column.

    Attributes:
        name: The set's name.
        force: Columns of the force's x, y and z.
        point: Columns of the point of application; all None, or at most one of them.
        moment: Columns of the moment; all, one (the free moment) or none.
    """

    name: str
    force: tuple[int, int, int]
    point: tuple[int | None, ...]
    moment: tuple[int | None, ...]


def force_column(name: str) -> ForceColumn | None:
    """Meaning of a column's name, or None where it names no axis."""
    text = _BRACKETS.sub(lambda match: " " * len(match.group()), name.lower())
    quantity: Quantity | None = None
    axes: list[tuple[int, int]] = []
    named: list[str] = []
    letters = False
    chunks = list(_CHUNKS.finditer(text))
    for chunk in chunks:
        word = chunk.group()
        if word in _ALONE and len(chunks) > 1:
            quantity, letters = _LETTERS[word], True
            continue
        match = None if word in {"l", "r", "left", "right"} | _ONLY_FILLING else _WORD.fullmatch(word)
        if match is None or word.isdigit():
            named += [word] if word not in _ONLY_FILLING else []
            continue
        found = [_WORDS[part] for part in _PART.findall(match["words"]) if part in _WORDS]
        found += [_LETTERS[match["letter"]]] if match["letter"] else []
        quantity = found[-1] if found else quantity
        if match["axis"]:
            axes.append((_AXES.index(match["axis"]), chunk.start() + match.start("axis")))
        named += [side for side in (match["side"], match["after"]) if side]
    if not axes and letters and len(named) > 1 and named[-1] in {"1", "2", "3"}:
        axes.append((int(named.pop()) - 1, chunks[-1].start()))
    if len(axes) != 1:
        return None
    return ForceColumn("_".join(named), quantity, *axes[0])


def force_sets(names: Sequence[str], where: str) -> tuple[ForceSet, ...]:
    """Sets of force columns of a table, in the order of their first force column; ``where`` is the file, for messages.

    Columns that have an axis and no quantity are the point of application of a set that has a force and no point.
    Names that occur several times belong to as many sets, which are numbered.

    Raises:
        FileFormatError: A column of a set is missing; names it.
        UnknownName: No column is a force.
    """
    columns = [force_column(name) for name in names]
    seen: dict[tuple[str, Quantity | None, int], list[int]] = {}
    for index, column in enumerate(columns):
        if column is not None:
            seen.setdefault((column.set_name, column.quantity, column.axis), []).append(index)
    order = dict.fromkeys(column.set_name for column in columns if column and column.quantity == "force")
    if not order:
        raise UnknownName(
            "ground reaction columns",
            ", ".join(names[:6]),
            ("ground_force_r_vx", "1_ground_force_vx", "ground_force1_vx"),
            where,
        )
    sets = []
    for set_name in order:
        most = max(len(seen.get((set_name, "force", axis), ())) for axis in range(3))
        for number in range(most):
            label = set_name or UNNAMED_SET
            if most > 1:
                label = f"{set_name}_{number + 1}" if set_name else str(number + 1)
            sets.append(_one_set(label, set_name, number, seen, names, where))
    return tuple(sets)


def _one_set(
    label: str,
    set_name: str,
    number: int,
    seen: dict[tuple[str, Quantity | None, int], list[int]],
    names: Sequence[str],
    where: str,
) -> ForceSet:
    """The columns of a set; ``number`` counts sets of the same name."""

    def of(quantity: Quantity | None) -> list[int | None]:
        lists = [seen.get((set_name, quantity, axis), []) for axis in range(3)]
        return [found[number] if number < len(found) else None for found in lists]

    force, point, moment = of("force"), of("point"), of("moment")
    if not any(index is not None for index in point):
        point = of(None)
    for group, most_missing in ((force, 0), (point, 1), (moment, 0 if _count(moment) > 1 else 2)):
        if group is not force and _count(group) == 0:
            continue
        if group.count(None) > most_missing:
            there = ", ".join(names[index] for index in group if index is not None)
            reason = f"column {_absent(group, names)} of set '{label}' is missing beside {there}"
            raise FileFormatError(where, f"{reason}; add it, or call columns like ground_force_r_vx")
    x, y, z = (int(index) for index in force if index is not None)
    return ForceSet(label, (x, y, z), tuple(point), tuple(moment))


def _count(group: Sequence[int | None]) -> int:
    return sum(index is not None for index in group)


def _absent(group: Sequence[int | None], names: Sequence[str]) -> str:
    """Name of the first column that is missing, after that of a column that is there."""
    there = names[next(index for index in group if index is not None)]
    column = force_column(there)
    assert column is not None  # the group was found by it
    written = there[column.place]
    axis = group.index(None)
    letter = str(axis + 1) if written.isdigit() else _AXES[axis]
    letter = letter.upper() if written.isupper() else letter
    return there[: column.place] + letter + there[column.place + 1 :]
