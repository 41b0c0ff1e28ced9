"""Axes and units of declared quantities: names and labels of every axis of an array, units that differ by label."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fnmatch import fnmatchcase
from itertools import product
from typing import NamedTuple

from mbkf.conventions import READING_KINDS


class Axis(NamedTuple):
    """An axis of arrays.

    Attributes:
        symbol: Its size in formulas.
        meaning: Its entries.
        names: Dataset that labels it; the field of the record, where the trial decides on the labels.
        labels: The labels, where they are the same in every trial.
    """

    symbol: str
    meaning: str
    names: str = ""
    labels: tuple[str, ...] = ()


WORLD = "x forward, y left, z up"
"""Directions of the world's axes, right-handed, as the capture's file has them after reading."""

AXES: Mapping[str, Axis] = {
    "time": Axis("T", "frames", "times_s"),
    "configuration": Axis("n_q", "numbers of the configuration", "configuration_names"),
    "dof": Axis("n_v", "degrees of freedom", "dof_names"),
    "coordinate": Axis("A", "clinical coordinates", "coordinate_names"),
    "marker": Axis("M", "markers", "marker_names"),
    "part": Axis("B", "parts of the body, besides the feet, that may bear load", "support_names"),
    "plate": Axis("K", "force plates of the capture", "plate_names"),
    "read_plate": Axis("K_r", "force plates that the filter reads", "read_plate_names"),
    "foot": Axis("2", "feet", "foot", ("right", "left")),
    "wrench": Axis(
        "6",
        f"force and moment on the body, world axes: {WORLD}",
        "wrench",
        tuple(f"{a}_{b}" for a in ("force", "moment") for b in "xyz"),
    ),
    "xyz": Axis("3", f"world axes: {WORLD}", "xyz", tuple("xyz")),
    "corner": Axis("4", "corners of a plate", "corner", tuple("1234")),
    "kind": Axis("4", "kinds of readings", "reading_kind", READING_KINDS),
    "state": Axis("2n_v", "configuration and velocity in the tangent space"),
    "ball": Axis("N", "joints with three angles"),
    "level": Axis("L", "levels of the spine", "level_names"),
    "muscle": Axis("E", "muscles with an electromyogram", "muscle_names"),
    "way": Axis("2", "from the part above the level, or below it", "way", ("top_down", "bottom_up")),
    "turn": Axis("3", "axes of the trunk's coordinates", "turn", ("extension", "bending", "rotation")),
    "unknown": Axis("n", "scale factors and places of markers on the body", "subject_unknown"),
    "source": Axis("n", "independent sources of these", "subject_source"),
}


class Unit(NamedTuple):
    """A unit, of every number of an array or of each entry of its last axis.

    Attributes:
        text: In words.
        by_label: Unit by pattern of the label, the first that fits; none where all entries have the same unit.
    """

    text: str
    by_label: tuple[tuple[str, str], ...] = ()

    def of(self, label: str) -> str:
        """The unit of the entry with a label."""
        return next((unit for pattern, unit in self.by_label if fnmatchcase(label, pattern)), self.text)


def _with_translations(angle: str, length: str) -> Unit:
    return Unit(f"{angle}; pelvis_t* {length}", (("*_t[xyz]", length), ("*", angle)))


ONE, SECOND, METRE, RADIAN, NEWTON, NEWTON_METRE, VOLT = (
    Unit(text) for text in ("1", "s", "m", "rad", "N", "N m", "V")
)
ANGLE = _with_translations("rad", "m")
RATE = _with_translations("rad/s", "m/s")
ACCELERATION = _with_translations("rad/s^2", "m/s^2")
FORCE = _with_translations("N m", "N")
CONFIGURATION = Unit(
    "m; unit quaternions (x, y, z, w); hinges rad", (("*_t[xyz]", "m"), ("*_q[xyzw]", "1"), ("*", "rad"))
)
PLATE_WRENCH = Unit("N, N m", (("force_*", "N"), ("*", "N m")))
WRENCH = Unit("N, N m about the world's origin", PLATE_WRENCH.by_label)


def shape_of(axes: Sequence[str], sizes: Mapping[str, int]) -> tuple[int, ...]:
    """Shape of an array.

    Args:
        axes: Its axes.
        sizes: Sizes of those that have other ones in every trial.
    """
    return tuple(len(AXES[axis].labels) or sizes[axis] for axis in axes)


def labels_of(axes: Sequence[str], names: Mapping[str, Sequence[str]]) -> Iterator[dict[str, str]]:
    """Labels by axis of every number of an array, the last axis fastest.

    Args:
        axes: The array's axes, without time.
        names: Labels of the axes that have other ones in every trial.
    """
    for labels in product(*(AXES[axis].labels or names[axis] for axis in axes)):
        yield dict(zip(axes, labels, strict=True))


def axes_text(axes: Sequence[str]) -> str:
    """An array's axes in their order, by the datasets that label them, with the labels that every trial has.

    E.g. ``times_s; foot: right, left; xyz: x, y, z``.
    """
    return "; ".join(
        f"{AXES[name].names or name}{': ' if AXES[name].labels else ''}{', '.join(AXES[name].labels)}"
        for name in axes
    )


def numbered(count: int) -> tuple[str, ...]:
    """Labels of entries that have no names: numbers from 1."""
    return tuple(str(k + 1) for k in range(count))
