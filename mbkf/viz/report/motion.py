"""The report's curves: joint angles, torques and reactions, over gait cycles and against time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, SIDES, Array
from mbkf.io.results import Reconstruction, varying_sd
from mbkf.model.description import BodyDescription
from mbkf.model.human import reference_body
from mbkf.numerics.runs import spread_indices
from mbkf.trial.gait.convention import BY_MODEL, Convention
from mbkf.trial.gait.curves import CURVE_PARTS, side_views
from mbkf.trial.gait.cycles import POINTS, Gait, over_cycle
from mbkf.trial.gait.facing import facing
from mbkf.viz.convention_words import angle_positive, angle_title, moment_note, moment_title, notes
from mbkf.viz.language import ENGLISH, words
from mbkf.viz.markup import folded, grid, key, paragraph, section, table
from mbkf.viz.report.reading import Reading, curve_of
from mbkf.viz.report.spreads import Curve, band_key, cycle_sd, offsets_known, spread_note
from mbkf.viz.svg import WIDTH, Line, Mark, chart, number
from mbkf.viz.wording import SIDE_NAMES, Wording, wordings

MOST_SINGLE = 8
"""Most cycles that are drawn one by one, evenly chosen; the mean is that of all."""

LONG_S, BROAD = 15.0, 1110.0
"""Curves over a longer time, s, are drawn with this width."""


@dataclass(frozen=True)
class JointNames:
    """Joints of a body that are shown together, without their sides.

    Attributes:
        legs: The root and the joints from it to the feet and toes.
        loaded: Joints with a torque: the reaction acts on the foot as a whole, so toes have none of their own.
        upper: All others.
    """

    legs: tuple[str, ...]
    loaded: tuple[str, ...]
    upper: tuple[str, ...]


def joint_names(body: BodyDescription) -> JointNames:
    """The joints of a body in their groups."""
    lower = {body.roles.root, *body.roles.legs, *body.roles.toes}
    names = {entry.distal: entry.name.removesuffix("_r").removesuffix("_l") for entry in body.clinical_joints}
    legs = dict.fromkeys(name for segment, name in names.items() if segment in lower)
    upper = dict.fromkeys(name for segment, name in names.items() if segment not in lower)
    unloaded = {names[segment] for segment in (body.roles.root, *body.roles.toes)}
    return JointNames(tuple(legs), tuple(name for name in legs if name not in unloaded), tuple(upper))


@dataclass(frozen=True)
class Cell:
    """One chart: a quantity of both sides, or of the midline.

    Attributes:
        title, unit, positive: Texts of the chart.
        curves: By side: "r" and "l", or "" alone.
        name: The coordinate without its side; empty for forces.
        caption: The convention.
    """

    title: str
    unit: str
    positive: str
    curves: dict[str, Curve]
    name: str = ""
    caption: str = ""


def motion_section(r: Reconstruction, gait: Gait | None, convention: Convention = BY_MODEL) -> str:
    """Angles and torques: over the gait cycle if there is gait, then against time.

    Args:
        r: The results.
        gait: The gait; None without.
        convention: Axes and signs of angles and torques.
    """
    read = Reading.of(r, convention)
    told = [paragraph(one) for one in notes(ENGLISH, convention, (read.angles.axes,))]
    body = [_unobserved(r), *told, paragraph(spread_note(r)), _ranges(r, read)]
    if gait is not None:
        drawn = partial(cycle_chart, r.times_s, gait)
        body += _curves(r, read, "over the gait cycle", drawn, gait, broad=False)
    against = _curves(r, read, "against time", partial(time_chart, r.times_s), None, broad=is_long(r))
    body += [folded("Angles and torques against time", *against)] if gait and is_long(r) else against
    return section("motion", "Joint angles and torques", *body)


def _curves(
    r: Reconstruction, read: Reading, how: str, draw: Callable[[Cell], str], gait: Gait | None, broad: bool
) -> list[str]:
    names, parts = joint_names(reference_body(r.subject)), []
    sense = paragraph(moment_note(ENGLISH, read.convention, _TORQUE_NOTE))
    for what, note, cells, lower in (
        ("angles", _key(r, gait), angle_cells, leg_angle_cells(r, names.legs, read)),
        ("torques", sense, torque_cells, torque_cells(r, names.loaded, read)),
    ):
        parts += [f"<h3>Joint {what} {how}</h3>", note, charts(lower, draw, broad)]
        if names.upper:
            upper = charts(cells(r, names.upper, read), draw, broad)
            parts.append(folded(f"Trunk, head and arms: {what}", upper))
    return parts


_TORQUE_NOTE = (
    "Torques of the muscles and ligaments about the axis of each angle, positive in the angle's direction, per kg of "
    "body mass: pushing off with the foot is a negative ankle dorsiflexion torque."
)


def reaction_section(r: Reconstruction, gait: Gait | None) -> str:
    """Ground reactions of both feet."""
    body = []
    if gait is not None:
        cells = reaction_cells(r, 100.0 / (r.subject.mass_kg * GRAVITY_M_S2), "% body weight")
        over_cycles = charts([cells], partial(cycle_chart, r.times_s, gait), False)
        body += ["<h3>Over the gait cycle</h3>", over_cycles]
    against = charts([reaction_cells(r, 1.0, "N")], partial(time_chart, r.times_s), is_long(r))
    body += ["<h3>Against time</h3>", against]
    return section("reactions", "Ground reactions", _key(r, gait), *body)


def leg_angle_cells(r: Reconstruction, joints: Sequence[str], read: Reading) -> list[list[Cell]]:
    """Charts of the legs' angles in the convention's order, those of the midline as each side sees them.

    Args:
        r: The results.
        joints: The body's joints, shown where the convention has no order of its own.
        read: The angles.
    """
    if not read.convention.rows:
        return angle_cells(r, joints, read)
    sides = [
        {one.name: one for one in side_views(r, k, read.convention, read.angles) if one.quantity == "angle"}
        for k in range(len(SIDES))
    ]
    rows = []
    for row in read.convention.rows:
        cells = []
        for name in row:
            title, positive = (
                word(ENGLISH, read.convention, name, words(ENGLISH, section).get(name, ""))
                for word, section in ((angle_title, "coordinates"), (angle_positive, "positive"))
            )
            curves = {
                side: curve_of(r, one[name].value, one[name][4:])
                for side, one in zip(SIDES, sides, strict=True)
                if name in one and np.isfinite(one[name].value).any()
            }
            if curves:
                cells.append(Cell(title, "°", positive, curves, name, read.caption))
        rows.append(cells)
    return [row for row in rows if row]


def angle_cells(r: Reconstruction, joints: Sequence[str], read: Reading | None = None) -> list[list[Cell]]:
    """Charts of angles, one row for each joint.

    Args:
        r: The results.
        joints: The joints, named without their sides.
        read: Angles and signs of a convention; None: the result's.
    """
    read = read or Reading.of(r, BY_MODEL)

    def curve(name: str, words: Wording) -> Curve:
        values, spreads = read.angles.of(name)
        return curve_of(r, words.factor * values, words.factor * spreads)

    return _cells(r, joints, "", curve, read.caption, lambda _, title: title)


def torque_cells(r: Reconstruction, joints: Sequence[str], read: Reading | None = None) -> list[list[Cell]]:
    """Charts of torques per body mass, one row for each joint.

    Args:
        r: The results.
        joints: The joints, named without their sides.
        read: Angles and signs of a convention; None: the result's.
    """
    read = read or Reading.of(r, BY_MODEL)
    convention, per_kg = read.convention, 1.0 / r.subject.mass_kg

    def curve(name: str, _: Wording) -> Curve:
        spreads = [per_kg * r.moment_sd(name, part) for part in CURVE_PARTS]
        return curve_of(r, convention.moment_sign(name[:-2]) * per_kg * r.moment(name), spreads)

    return _cells(r, joints, "N m/kg", curve, read.moment_caption, partial(moment_title, ENGLISH, convention))


def reaction_cells(r: Reconstruction, factor: float, unit: str) -> list[Cell]:
    """Charts of the three components of the reactions: upward, in the direction the person faces, to the left.

    Args:
        r: The results.
        factor: Factor from N to the unit shown.
        unit: The unit shown.
    """
    sd = np.full_like(r.foot_wrench, np.nan) if r.foot_wrench_sd is None else r.foot_wrench_sd
    offset, change = r.foot_wrench_sd_offset, r.foot_wrench_sd_change
    parts = []
    if offsets_known(r) and offset is not None and change is not None:
        parts = [offset, varying_sd(sd, offset, change)]
    feet = {
        side: Curve(*(one[:, k, :3] for one in (r.foot_wrench, sd, *parts))) for k, side in enumerate(SIDES)
    }
    return force_cells(facing(r), feet, factor, unit)


def force_cells(
    axes: Array, forces: dict[str, Curve], factor: float, unit: str, part: str = ""
) -> list[Cell]:
    """Charts of the three components of forces.

    Args:
        axes: (T, 3, 3) rows: forward, to the left, up.
        forces: (T, 3) world force with its spread by side.
        factor: Factor from N to the unit shown.
        unit: The unit shown.
        part: Part of the body, put before the charts' titles.
    """
    cells = []
    for title, axis, positive in (
        ("Vertical", 2, "upward"),
        ("Fore-aft", 0, "forward"),
        ("Sideways", 1, "to the left"),
    ):
        curves: dict[str, Curve] = {}
        for side, (force, *spreads) in forces.items():
            along = np.einsum("tj,tj->t", axes[:, axis], force)
            shown = [
                factor * np.sqrt(np.einsum("tj,tj->t", axes[:, axis] ** 2, sd**2))
                for sd in spreads
                if sd is not None
            ]
            curves[side] = Curve(factor * along, *shown)
        cells.append(Cell(f"{part}, {title.lower()}" if part else title, unit, positive, curves))
    return cells


def _cells(
    r: Reconstruction,
    joints: Sequence[str],
    unit: str,
    curve: Callable[[str, Wording], Curve],
    caption: str,
    title: Callable[[str, str], str],
) -> list[list[Cell]]:
    known_joints = reference_body(r.subject).clinical_joints
    words, rows = wordings(known_joints), []
    segments = {entry.main: entry.distal for entry in known_joints}
    for joint in joints:
        entries = [e for e in known_joints if e.name in (joint, f"{joint}_r")]
        if not entries or _is_unobserved(r, segments[entries[0].main]):
            continue
        row = []
        for angle in entries[0].angles:
            w = words[angle.name]
            names = {"r": angle.name, "l": angle.name[:-2] + "_l"} if w.side else {"": angle.name}
            known = {side: name for side, name in names.items() if name in r.coordinate_names}
            curves = {side: curve(name, words[name]) for side, name in known.items()}
            if any(np.isfinite(one.values).any() for one in curves.values()):
                base = angle.name.removesuffix("_r")
                shown = title(base, w.title)
                positive = w.positive if shown == w.title else ""
                row.append(Cell(shown, unit or w.unit, positive, curves, base, caption))
        if row:
            rows.append(row)
    return rows


def _is_unobserved(r: Reconstruction, segment: str) -> bool:
    return any(name.startswith(f"{segment}_") for name in r.unobserved_dofs)


def charts(rows: list[list[Cell]], draw: Callable[[Cell], str], broad: bool) -> str:
    """Charts, three in a row, or wide ones below each other.

    Args:
        rows: The cells of each row.
        draw: Makes a cell's chart.
        broad: True for charts as wide as the page.
    """
    if not rows:
        return paragraph("Not known: no force plate measured this trial.")
    if broad:
        return grid((draw(cell) for row in rows for cell in row), columns=1)
    return grid(chart for row in rows for chart in [*(draw(cell) for cell in row), "", ""][:3])


def time_chart(times_s: Array, cell: Cell) -> str:
    """A cell against time; as wide as the page in a long trial."""
    lines = [
        Line(times_s, one.values, one.sd, side, inner_sd=one.inner_sd) for side, one in cell.curves.items()
    ]
    span = (float(times_s[0]), float(max(times_s[-1], times_s[0] + 1e-3)))
    width = BROAD if span[1] - span[0] > LONG_S else WIDTH
    note = _positive(cell)
    return chart(cell.title, cell.unit, lines, span, "s", note=note, width=width, caption=cell.caption)


def _positive(cell: Cell) -> str:
    return f"positive: {cell.positive}" if cell.positive else ""


def cycle_chart(times_s: Array, gait: Gait, cell: Cell) -> str:
    """A cell over 0–100 % of the cycles of each side: every cycle lightly, their mean with its band.

    The midline is shown over the cycles of the right foot, or of the left if the right has no cycle.

    Args:
        times_s: (T,) times of the frames, s.
        gait: The gait cycles of both sides.
        cell: The curves to draw.
    """
    percent = np.linspace(0.0, 100.0, POINTS)
    thin, bold, marks = [], [], []
    for side, curve in cell.curves.items():
        cycles = gait.of(SIDES.index(side)) if side else gait.of(0) or gait.of(1)
        if not cycles:
            continue
        each = np.array([over_cycle(times_s, curve.values, cycle) for cycle in cycles])
        wide, inner = (cycle_sd(times_s, sd, cycles) for sd in (curve.sd, curve.inner_sd))
        if len(cycles) > 1:
            some = spread_indices(len(cycles), MOST_SINGLE)
            thin += [Line(percent, one, None, side, thin=True) for one in each[some]]
        bold.append(Line(percent, each.mean(axis=0), wide, side, inner_sd=inner))
        if side:
            marks.append(Mark(float(np.mean([cycle.off_percent for cycle in cycles])), side))
    note, lines = _positive(cell), [*thin, *bold]
    return chart(
        cell.title, cell.unit, lines, (0.0, 100.0), "%", marks=marks, note=note, caption=cell.caption
    )


def is_long(r: Reconstruction) -> bool:
    """True if curves against time are drawn as wide as the page."""
    return float(np.ptp(r.times_s)) > LONG_S


def _key(r: Reconstruction, gait: Gait | None) -> str:
    entries = [("swatch r", "right"), ("swatch l", "left"), *band_key(offsets_known(r))]
    if gait is not None:
        counts = " and ".join(f"{_some(len(gait.of(i)))} {SIDE_NAMES[side]}" for i, side in enumerate(SIDES))
        if len(gait.cycles) > 2:
            entries.append(("swatch thin", f"single cycles ({counts}), their mean in bold"))
        entries.append(("swatch off", "toe-off"))
    return key(*entries)


def _some(count: int) -> str:
    return str(count) if count <= MOST_SINGLE else f"{MOST_SINGLE} of {count}"


def _unobserved(r: Reconstruction) -> str:
    if not r.unobserved_dofs:
        return ""
    segments = sorted({name.rpartition("_")[0].replace("_", " ") for name in r.unobserved_dofs})
    return paragraph(f"Not shown, because neither markers nor sensors observe them: {', '.join(segments)}.")


def _ranges(r: Reconstruction, read: Reading) -> str:
    """Least and greatest angle and torque of the main angle of each joint of the legs."""
    rows = []
    loaded = joint_names(reference_body(r.subject)).loaded
    loads = {torque.name: torque.curves for torque, *_ in torque_cells(r, loaded, read)}
    for angle, *_ in angle_cells(r, loaded, read):
        for side, name in SIDE_NAMES.items():
            load = _extremes(loads.get(angle.name, {}).get(side), 2)
            rows.append((f"{angle.title}, {name}", *_extremes(angle.curves.get(side), 1), *load))
    if not rows:
        return ""
    kind = "extension moment" if read.convention.reversed_moments else "torque"
    heads = ("", "least angle °", "greatest angle °", f"least {kind} N m/kg", f"greatest {kind} N m/kg")
    shift = "; in brackets, its part that repeats in the same posture" if offsets_known(r) else ""
    return f"<h3>Ranges (± 2 standard deviations{shift})</h3>" + table(heads, rows)


def _extremes(curve: Curve | None, digits: int) -> tuple[str, str]:
    if curve is None or not np.isfinite(curve.values).any():
        return "–", "–"
    values, sd, offset, _ = curve
    found = []
    for at in (int(np.nanargmin(values)), int(np.nanargmax(values))):
        band = "" if not np.isfinite(sd[at]) else f" ± {number(2 * sd[at], digits)}"
        if band and offset is not None:
            band += f" ({number(2 * offset[at], digits)})"
        found.append(number(float(values[at]), digits) + band)
    return found[0], found[1]
