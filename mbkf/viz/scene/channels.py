"""Rows of numbers for the drawing, on the live page and in playback, and the quantities to plot.

A row is one frame: poses of the segments, markers, reactions and every curve, one after another as 32-bit numbers; NaN
stands for unknown. The page receives the offset of each part once.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np

from mbkf.conventions import SIDES, Array, BoolArray
from mbkf.io.contacts import FEET
from mbkf.io.dimensions import AXES, labels_of, shape_of
from mbkf.io.results import PLOTTED
from mbkf.model.clinical_table import ClinicalJoint
from mbkf.viz.wording import SIDE_NAMES, TRUNK_POSITIVE, part_wording, wordings

SEEN, UNSEEN, REFUSED = 0, 1, 2
"""States of a marker: measured and used, not measured (or hidden), measured but rejected by the gate."""

RESOLUTION = {
    "segments": 2e-4, "measured": 2e-4, "predicted": 2e-4, "force": 0.2, "force_sd": 0.2, "pressure": 5e-4,
    "angles": 3e-4, "angles_sd": 2e-4, "moments": 0.02, "moments_sd": 0.02, "source": 1.0,
    "trunk": 0.02, "trunk_sd": 0.02,
}  # fmt: skip
RESOLUTION |= {name: one.plot.resolution for name, one in PLOTTED.items() if one.plot}
"""Visible resolution of a part's numbers; recordings are rounded to it."""

FORCE_AXES = (("vertical", "Vertical", "", 2), ("x", "", " along x", 0), ("y", "", " along y", 1))
"""Components of a force: name, words before and after its kind, world axis."""

TRUNK_ROWS = len(AXES["way"].labels) * len(AXES["turn"].labels)
"""Moments of the trunk at a level of the spine."""

STATUS = ("time_s", "number", "latency_ms", "rate_hz", "lost", "tracked", "unexplained")
"""The first numbers of a row."""


@dataclass(frozen=True)
class Quantity:
    """A quantity that can be plotted.

    Attributes:
        id: Name that stays the same from run to run, e.g. "angle:knee_angle_r".
        group: Heading of its list.
        title: Its name, with the side.
        side: "r", "l" or "".
        unit: Unit shown.
        positive: Meaning of a positive value; "" where that is plain.
        factor: Factor from the row's number to the unit.
        column: Its column in the row.
        sd_column: Column of its standard deviation; -1 without.
    """

    id: str
    group: str
    title: str
    side: str
    unit: str
    positive: str
    factor: float
    column: int
    sd_column: int = -1


class Layout:
    """The place of each part in a row.

    Attributes:
        parts: First column and width of each part, by name: status, segments (position, quaternion x y z w each),
            measured and predicted markers, state of each marker, force, force_sd, pressure point and source
            (:class:`mbkf.io.contacts.Source`) of the loads on feet and other parts, angles, angles_sd, moments,
            moments_sd, trunk and trunk_sd (by way, level and turn), declared curves
            (:data:`mbkf.io.results.PLOTTED`), unlabelled points.
        loads: Names of the parts of the body with loads, the feet first.
        levels: Levels of the spine at which the trunk's moments are shown.
        width: Numbers in a row.
    """

    def __init__(
        self,
        segments: int,
        markers: int,
        coordinates: int,
        unlabelled: int = 0,
        supports: tuple[str, ...] = (),
        levels: tuple[str, ...] = (),
    ) -> None:
        """Parts of a row, one after another.

        Args:
            segments: Number of segments.
            markers: Number of markers.
            coordinates: Number of clinical coordinates.
            unlabelled: Greatest number of points without names.
            supports: Parts that bear load besides the feet.
            levels: Levels of the spine at which the trunk's moments are shown.
        """
        self.loads, self.levels = (*FEET, *supports), levels
        widths = {
            "status": len(STATUS),
            "segments": 7 * segments,
            "measured": 3 * markers,
            "predicted": 3 * markers,
            "state": markers,
            "force": 3 * len(self.loads),
            "force_sd": 3 * len(self.loads),
            "pressure": 3 * len(self.loads),
            "source": len(self.loads),
            "angles": coordinates,
            "angles_sd": coordinates,
            "moments": coordinates,
            "moments_sd": coordinates,
            "trunk": TRUNK_ROWS * len(levels),
            "trunk_sd": TRUNK_ROWS * len(levels),
        }
        sizes = {"coordinate": coordinates, "marker": markers}
        for name, one in PLOTTED.items():
            widths[name] = math.prod(shape_of(one.axes[1:], sizes))
        widths["unlabelled"] = 3 * unlabelled
        self.parts: dict[str, tuple[int, int]] = {}
        self.width = 0
        for name, width in widths.items():
            self.parts[name] = (self.width, width)
            self.width += width

    def blank(self, frames: int) -> Array:
        """(frames, width) rows of NaN."""
        return np.full((frames, self.width), np.nan)

    def put(self, rows: Array, part: str, values: Array) -> None:
        """Writes one part of rows.

        Args:
            rows: (T, width) the rows, changed in place.
            part: Name of the part.
            values: T values of any shape that fills the part.
        """
        first, width = self.parts[part]
        rows[:, first : first + width] = values.reshape(len(rows), width)

    def resolution(self) -> Array:
        """(width,) the :data:`RESOLUTION` of every column, 0 where it has none."""
        return np.concatenate(
            [np.full(width, RESOLUTION.get(p, 0.0)) for p, (_, width) in self.parts.items()]
        )

    def column(self, part: str, offset: int = 0) -> int:
        """Column of the n-th number of a part."""
        return self.parts[part][0] + offset


def marker_states(measured_m: Array, hidden: BoolArray, refused: BoolArray) -> Array:
    """(…, M) state of markers: :data:`SEEN`, :data:`UNSEEN` or :data:`REFUSED`.

    Args:
        measured_m: (…, M, 3) measured positions, m; NaN where missing.
        hidden: (…, M) markers withheld from the filter.
        refused: (…, M) markers rejected by the gate.
    """
    unseen = np.isnan(measured_m).any(axis=-1) | hidden
    return np.where(unseen, UNSEEN, np.where(refused, REFUSED, SEEN)).astype(float)


def quantities(
    layout: Layout,
    coordinate_names: tuple[str, ...],
    joints: Iterable[ClinicalJoint],
    streamed: bool,
    own_levels: Mapping[str, str] | None = None,
) -> list[Quantity]:
    """All quantities that can be plotted, in the order of the page's list.

    Args:
        layout: Of the rows.
        coordinate_names: (A,) clinical coordinates.
        joints: The body's clinical joints.
        streamed: True with latency, rate and lost frames.
        own_levels: Level of the spine that a joint lies at, by its name without the side.
    """
    words, at_level = wordings(joints), own_levels or {}
    found = []
    for group, part, of_load in (("Angles", "angles", False), ("Torques", "moments", True)):
        for a, name in enumerate(coordinate_names):
            w = words[name]
            residual = of_load and w.root
            suffix = "" if not of_load else (" residual" if residual else " torque")
            side = f", {SIDE_NAMES[w.side]}" if w.side else ""
            if of_load and w.joint in at_level:
                side += f", {at_level[w.joint]}"
            found.append(
                Quantity(
                    id=f"{'torque' if of_load else 'angle'}:{name}",
                    group="Residuals at the pelvis" if residual else group,
                    title=f"{w.title}{suffix}{side}",
                    side=w.side,
                    unit=w.load_unit if of_load else w.unit,
                    positive=w.positive,
                    factor=1.0 if of_load else w.factor,
                    column=layout.column(part, a),
                    sd_column=layout.column(f"{part}_sd", a),
                )
            )
    found += _of_trunk(layout)
    found += [one for k in range(len(layout.loads)) for one in _of_load(layout, k)]
    found += [one for name in PLOTTED for one in _declared(layout, name, coordinate_names)]
    if streamed:
        for name, title, unit in (
            ("latency_ms", "Latency", "ms"), ("rate_hz", "Frame rate", "Hz"), ("lost", "Frames lost", ""),
        ):  # fmt: skip
            column = layout.column("status", STATUS.index(name))
            found.append(Quantity(f"stream:{name}", "Stream", title, "", unit, "", 1.0, column))
    return sorted(found, key=lambda q: GROUPS.index(q.group))


def _of_trunk(layout: Layout) -> Iterator[Quantity]:
    """The trunk's moments at the levels of the spine, both ways."""
    labels = product(AXES["way"].labels, layout.levels, AXES["turn"].labels)
    for k, (way, level, turn) in enumerate(labels):
        yield Quantity(
            id=f"trunk:{level}:{turn}:{way}",
            group="Torques",
            title=f"Trunk {turn} torque, {level}, {way.replace('_', '-')}",
            side="",
            unit="N m",
            positive=TRUNK_POSITIVE[turn],
            factor=1.0,
            column=layout.column("trunk", k),
            sd_column=layout.column("trunk_sd", k),
        )


def _of_load(layout: Layout, k: int) -> list[Quantity]:
    """The components of the k-th load."""
    is_foot, part = k < len(SIDES), part_wording(layout.loads[k])
    what = "reaction" if is_foot else "force"
    return [
        Quantity(
            id=f"reaction:{name}_{part.side}" if is_foot else f"load:{name}_{layout.loads[k]}",
            group="Ground reactions" if is_foot else "Other loads",
            title=f"{before} {what}{after}".strip().capitalize()
            + f", {SIDE_NAMES[part.side] if is_foot else part.full_title.lower()}",
            side=part.side,
            unit="N",
            positive="upward" if name == "vertical" else "",
            factor=1.0,
            column=layout.column("force", 3 * k + axis),
            sd_column=layout.column("force_sd", 3 * k + axis),
        )
        for name, before, after, axis in FORCE_AXES
    ]


def _declared(layout: Layout, name: str, coordinate_names: tuple[str, ...]) -> Iterator[Quantity]:
    """Curves of a declared quantity: one, or one for each label of its axis."""
    declared, plot = PLOTTED[name], PLOTTED[name].plot
    assert plot is not None
    for k, labels in enumerate(labels_of(declared.axes[1:], {"coordinate": coordinate_names})):
        words = list(labels.values())
        yield Quantity(
            id=":".join([name, *words]),
            group=plot.group,
            title=", ".join([plot.title, *words]),
            side=labels.get("foot", "")[:1],
            unit=plot.unit,
            positive="",
            factor=plot.factor,
            column=layout.column(name, k),
        )


GROUPS = ("Angles", "Torques", "Ground reactions", "Other loads", "Residuals at the pelvis", "Stream")
"""Headings of the list of quantities, in order."""
