"""Show the degrees of freedom that a marker protocol determines.

A degree of freedom is determined when the marker Jacobian H has no null direction along it. The observability matrix
[H; HF; HF²; …] of the kinematic filter says the same of positions and velocities together. Postures: standing straight,
and four in which every joint is bent.

Examples:
  mbkf observability reference36
  mbkf observability reference36 --lost RHAL,RMID
  mbkf observability my_markers.toml
  mbkf observability                    all protocols that come with mbkf
"""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

import numpy as np

from mbkf.cli.options import comma_separated
from mbkf.cli.tables import table, terminal

if TYPE_CHECKING:
    from rich.table import Table

    from mbkf.sensors.observability import Observability
    from mbkf.trial.observability import ProtocolObservability

WEAKEST_SHOWN = 5


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("protocol", nargs="?", help="its name or TOML file (default: all)")
    parser.add_argument("--lost", metavar="A,B", default="", help="markers to take away, separated by commas")


def run(args: argparse.Namespace) -> int:
    """Prints the tables.

    Raises:
        InvalidInput: Markers are lost, but no protocol is named.
    """
    from mbkf.errors import InvalidInput
    from mbkf.model.protocol import load_protocol, protocol_names
    from mbkf.trial.observability import check_protocol

    lost = comma_separated(args.lost)
    if args.protocol is not None:
        _show(check_protocol(load_protocol(args.protocol), lost))
    elif lost:
        raise InvalidInput("--lost needs the protocol whose markers are lost")
    else:
        terminal().print(_overview([check_protocol(load_protocol(name)) for name in protocol_names()]))
    return 0


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
            shown.add_row(name, f"{100 * found.unobserved_share[0, i]:.0f} %", f"{100 * bent[i]:.0f} %")
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
