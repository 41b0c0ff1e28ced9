"""Show the degrees of freedom that a marker protocol determines, and the torques and reactions beside them.

A degree of freedom is determined when the marker Jacobian H has no null direction along it. The observability matrix
[H; HF; HF²; …] of the kinematic filter says the same of positions and velocities together. Postures: standing straight,
and four in which every joint is bent.

With --filter torque or dynamic the same is asked of that filter's whole state: torques or accelerations, and the
reactions of both feet, each on a plate of its own unless --without-plate takes it away.

Examples:
  mbkf observability reference36
  mbkf observability reference36 --lost RHAL,RMID
  mbkf observability my_markers.toml
  mbkf observability                    all protocols that come with mbkf
  mbkf observability reference36 --preset FDMC-literal --without-plate
  mbkf observability reference36 --preset FDMC --set plates=inputs
  mbkf observability reference36 --filter dynamic --without-plate left
"""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

import numpy as np

from mbkf.cli.options import add_preset_options, comma_separated, with_chosen
from mbkf.cli.tables import table, terminal
from mbkf.numerics.printed import percent

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.table import Table

    from mbkf.filters.observability import Component, StateObservability
    from mbkf.sensors.observability import Observability
    from mbkf.trial.filter_observability import FilterObservability
    from mbkf.trial.observability import ProtocolObservability

WEAKEST_SHOWN = 5
CLEAR_GAP = 100.0
"""Ratio of singular values on both sides of the bound from which the rank is beyond doubt."""

MAIN_SHARE = 0.2
"""A component is named with a direction if it makes up this much of it."""


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("protocol", nargs="?", help="its name or TOML file (default: all)")
    parser.add_argument("--lost", metavar="A,B", default="", help="markers to take away, separated by commas")
    parser.add_argument(
        "--filter",
        choices=("kinematic", "torque", "dynamic"),
        help="the filter whose state is asked of (default: that of the preset, or kinematic)",
    )
    add_preset_options(parser)
    parser.add_argument(
        "--without-plate",
        metavar="N",
        action="append",
        nargs="?",
        const="both",
        default=[],
        help="foot without a plate: right or 1, left or 2, both (default); may be repeated",
    )


def run(args: argparse.Namespace) -> int:
    """Prints the tables.

    Raises:
        InvalidInput: Markers are lost, but no protocol is named; or a plate is missing that the filter does not read.
    """
    from mbkf.errors import InvalidInput
    from mbkf.model.protocol import load_protocol, protocol_names
    from mbkf.trial.preparation.settings import ReconstructSettings

    lost = comma_separated(args.lost)
    if lost and args.protocol is None:
        raise InvalidInput("--lost needs the protocol whose markers are lost")
    settings = with_chosen(ReconstructSettings(filter=args.filter or "kinematic"), args)
    names = protocol_names() if args.protocol is None else (args.protocol,)
    protocols = [load_protocol(name) for name in names]
    if settings.filter != "kinematic":
        from mbkf.trial.filter_observability import check_filter

        checks = [check_filter(one, settings, lost, args.without_plate) for one in protocols]
        if args.protocol is None:
            terminal().print(_state_overview(checks))
        else:
            _show_state(checks[0])
        return 0
    from mbkf.trial.observability import check_protocol

    if args.without_plate:
        raise InvalidInput(
            "--without-plate: the kinematic filter reads no plate; give --filter torque or dynamic"
        )
    if args.protocol is not None:
        _show(check_protocol(protocols[0], lost))
    else:
        terminal().print(_overview([check_protocol(one) for one in protocols]))
    return 0


def _show_state(check: FilterObservability) -> None:
    from mbkf.filters.observability import OBSERVED_SD, WINDOW_S

    console, size = terminal(), len(check.state)
    console.print(f"{check.protocol.title} ({check.protocol.name}), {len(check.markers)} markers")
    if check.lost:
        console.print(f"without {', '.join(check.lost)}")
    plates = [f"no plate under the {foot} foot" for foot in check.without] or ["a plate under each foot"]
    console.print(f"{', '.join(plates)}")
    parts = ", ".join(f"{part} {count}" for part, count in _counted(check.state).items())
    console.print(f"{check.filter} filter, state of {size}: {parts}")
    if check.loads_given:
        missing = (
            "; without a plate that of a foot counts as 0, and is missing in the residual"
            if check.without
            else ""
        )
        console.print(f"Wrenches of the feet are known inputs{missing}.")
    ranks = table("", "", "standing still", "in motion (least)")
    ranks.add_row("rank of H", *_ranks([one.reading_rank for one in check.found], size))
    for name, points in check.variants.items():
        ranks.add_row(f"rank of [H; HF; HF²; …], {name}", *_ranks([one.rank for one in points], size))
    console.print(ranks)
    counted, silent = np.array([one.gap for one in check.found]).T
    silence = "" if np.isnan(silent).all() else f", greatest that does not {np.nanmax(silent):.1e}"
    console.print(
        f"Singular values, in standard deviations of the readings over {1000 * WINDOW_S:.0f} ms: "
        f"least that counts {counted.min():.2g}{silence} (bound {OBSERVED_SD:g})."
    )
    if np.nanmax(silent, initial=0.0) > counted.min() / CLEAR_GAP:
        console.print(
            "Values lie close to the bound on both sides: those directions are hardly observed either way."
        )
    if check.complete:
        console.print(f"All {size} components of the state are determined.")
    else:
        console.print(_silent(check))
    console.print(_faintest(check.state, check.found[1:]))


def _ranks(ranks: Sequence[int], size: int) -> tuple[str, str]:
    return f"{ranks[0]} of {size}", f"{min(ranks[1:])} of {size}"


def _counted(state: Sequence[Component]) -> dict[str, int]:
    counts: dict[str, int] = {}
    for one in state:
        counts[one.part] = counts.get(one.part, 0) + 1
    return counts


def _silent(check: FilterObservability) -> Table:
    """Components with a share in the directions that no reading shows, those of a segment or load in one row."""
    missing = len(check.state) - min(one.rank for one in check.found[1:])
    title = f"{missing} directions of the state do not show (share 100 %: not observed at all)"
    shown = table(title, "part", "not determined", "share", words=2)
    share = dict(zip(check.state, check.unobserved_share, strict=True))
    grouped: dict[tuple[str, str], list[Component]] = {}
    for one in check.unobserved:
        grouped.setdefault((one.part, one.name[:-2]), []).append(one)
    for (part, place), own in grouped.items():
        shares = [100 * share[one] for one in own]
        least, most = f"{min(shares):.0f}", f"{max(shares):.0f} %"
        axes = ", ".join(one.name[-1] for one in own)
        shown.add_row(part, f"{place} {axes}", most if f"{least} %" == most else f"{least} to {most}")
    return shown


def _faintest(state: Sequence[Component], points: Sequence[StateObservability]) -> Table:
    """Determined directions that change the readings least, at the point where they do so least."""
    point = min(points, key=lambda one: one.singular_values[one.rank - 1])
    shown = table("", "direction observed least", "change of the readings, standard deviations")
    last = point.rank - 1
    for k in range(last, max(last - WEAKEST_SHOWN, -1), -1):
        share = point.directions[k] ** 2
        main = [i for i in np.argsort(-share)[:2] if share[i] >= MAIN_SHARE]
        words = " and ".join(f"{state[i].part} {state[i].name}" for i in main) or "many components"
        shown.add_row(words, f"{point.singular_values[k]:.2g}")
    return shown


def _state_overview(checks: Sequence[FilterObservability]) -> Table:
    title = f"{checks[0].filter} filter"
    shown = table(title, "protocol", "markers", "rank of the state", "not fully determined", words=4)
    for check in checks:
        rank = min(one.rank for one in check.found)
        open_ones = ", ".join(_both_sides(list(dict.fromkeys(map(_place, check.unobserved))))) or "none"
        shown.add_row(
            check.protocol.name, str(len(check.markers)), f"{rank} of {len(check.state)}", open_ones
        )
    return shown


def _place(component: Component) -> str:
    """Where a component is: its segment, or the load that it belongs to."""
    own = component.part.endswith(("position", "velocity", "acceleration", "torque"))
    load = f"load on {component.part}" if component.part.endswith("foot") else component.part
    return component.name[:-2] if own else load


def _show(check: ProtocolObservability) -> None:
    console, found = terminal(), check.after
    nv = len(found.dofs)
    console.print(f"{check.protocol.title} ({check.protocol.name}), {len(check.markers)} markers")
    if check.lost:
        console.print(f"without {', '.join(check.lost)}")
    ranks = table("", "", "standing straight", "joints bent (least)")
    for name, values, most in (
        ("rank of H", found.ranks, nv),
        ("rank of [H; HF; HF²; …]", found.state_ranks, 2 * nv),
    ):
        ranks.add_row(name, f"{values[0]} of {most}", f"{values[1:].min()} of {most}")
    console.print(ranks)
    if found.complete:
        console.print(f"All {nv} degrees of freedom and their velocities are determined.")
    else:
        console.print(_undetermined(found))
    if check.lost:
        console.print(f"Lost with these markers: {', '.join(check.lost_dofs) or 'nothing'}.")
    console.print(_weakest(found))


def _undetermined(found: Observability) -> Table:
    """Degrees of freedom that some posture leaves open, each with its share in the null space."""
    shown = table("100 %: not observed at all", "not determined", "unobserved, standing", "unobserved, bent")
    bent = np.median(found.unobserved_share[1:], axis=0)
    for i, name in enumerate(found.dofs):
        if name in {*found.unobserved, *found.sometimes_unobserved}:
            shown.add_row(name, percent(found.unobserved_share[0, i]), percent(bent[i]))
    return shown


def _weakest(found: Observability) -> Table:
    """The determined rotations with the largest standard deviation from a single frame."""
    shown = table("", "least certain", "standard deviation of one frame, joints bent")
    turns = np.array(["_t" not in name[-3:] for name in found.dofs])
    sd = np.where(np.isfinite(found.typical_sd) & turns, found.typical_sd, -1.0)
    for i in np.argsort(-sd)[:WEAKEST_SHOWN]:
        shown.add_row(found.dofs[i], f"{np.rad2deg(sd[i]):.1f}°")
    return shown


def _overview(checks: list[ProtocolObservability]) -> Table:
    shown = table("", "protocol", "markers", "rank of H", "segments not fully determined", words=4)
    for check in checks:
        found = check.after
        segments = dict.fromkeys(
            name.rsplit("_", 1)[0] for name in found.unobserved + found.sometimes_unobserved
        )
        rank = f"{found.ranks.min()} of {len(found.dofs)}"
        open_ones = ", ".join(_both_sides(list(segments))) or "none"
        shown.add_row(check.protocol.name, str(len(check.markers)), rank, open_ones)
    return shown


def _both_sides(segments: list[str]) -> list[str]:
    """Names for people: ``right_hand`` and ``left_hand`` together become ``hand (r, l)``."""
    words: list[str] = []
    for segment in segments:
        side, _, rest = segment.partition("_")
        if side == "left" and f"right_{rest}" in segments:
            continue
        paired = side == "right" and f"left_{rest}" in segments
        words.append((f"{rest} (r, l)" if paired else segment).replace("_", " "))
    return words
