"""`mbkf observability`: which degrees of freedom a marker protocol determines."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from rich.table import Table

    from mbkf.sensors.observability import Observability
    from mbkf.trial.observability import ProtocolObservability

WEAKEST_SHOWN = 5
_EPILOG = """\
A dof is determined when the marker Jacobian H has no null direction along it. The observability matrix
[H; HF; HF²; …] of the kinematic filter says the same of positions and velocities together. Postures: standing
straight, and four in which every joint is bent.

examples:
  mbkf observability reference36
  mbkf observability reference36 --lost RHAL,RMID
  mbkf observability my_markers.toml
  mbkf observability                    all protocols that come with mbkf
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the command to the command line."""
    parser = subparsers.add_parser(
        "observability",
        help="which degrees of freedom a marker protocol determines",
        description="Which degrees of freedom a marker protocol determines, and which go with lost markers.",
        epilog=_EPILOG,
    )
    parser.add_argument("protocol", nargs="?", help="its name or TOML file; all of them when left out")
    parser.add_argument("--lost", metavar="A,B", default="", help="markers to take away, separated by commas")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Prints the tables.

    Raises:
        UnknownName: The protocol or a lost marker is unknown.
        FileFormatError: The protocol file is not valid.
        NotObservable: No marker is left.
        InvalidInput: Markers are lost, but no protocol is named.
    """
    from rich.console import Console

    from mbkf.errors import InvalidInput
    from mbkf.model.protocol import load_protocol, protocol_names
    from mbkf.trial.observability import check_protocol

    console = Console(highlight=False)
    lost = [name.strip() for name in args.lost.split(",") if name.strip()]
    if args.protocol is None:
        if lost:
            raise InvalidInput("--lost needs the protocol whose markers are lost")
        console.print(_overview([check_protocol(load_protocol(name)) for name in protocol_names()]))
        return 0
    _show(check_protocol(load_protocol(args.protocol), lost))
    return 0


def _show(check: ProtocolObservability) -> None:
    from rich.console import Console

    console = Console(highlight=False)
    found = check.after
    nv = len(found.dofs)
    console.print(f"[bold]{check.protocol.title}[/] ({check.protocol.name}), {len(check.markers)} markers")
    if check.lost:
        console.print(f"without {', '.join(check.lost)}")
    console.print(_ranks(found))
    if found.complete:
        console.print(f"All {nv} degrees of freedom and their velocities are determined.")
    else:
        console.print(_undetermined(found))
    if check.lost:
        console.print(f"Lost with these markers: {', '.join(check.lost_dofs) or 'nothing'}.")
    console.print(_weakest(found))


def _ranks(found: Observability) -> Table:
    from rich.table import Table

    nv = len(found.dofs)
    table = Table("", "standing straight", "joints bent (least)")
    table.add_row("rank of H", f"{found.ranks[0]} of {nv}", f"{found.ranks[1:].min()} of {nv}")
    table.add_row(
        "rank of [H; HF; HF²; …]",
        f"{found.state_ranks[0]} of {2 * nv}",
        f"{found.state_ranks[1:].min()} of {2 * nv}",
    )
    return table


def _undetermined(found: Observability) -> Table:
    """One row per dof that some posture leaves open, with its share in the null space."""
    from rich.table import Table

    table = Table(
        "not determined", "unobserved, standing", "unobserved, bent", title="100 %: not seen at all"
    )
    names = set(found.unobserved) | set(found.sometimes_unobserved)
    bent = np.median(found.unobserved_share[1:], axis=0)
    for i, name in enumerate(found.dofs):
        if name in names:
            table.add_row(name, f"{100 * found.unobserved_share[0, i]:.0f} %", f"{100 * bent[i]:.0f} %")
    return table


def _weakest(found: Observability) -> Table:
    """The determined rotations that one frame alone knows least."""
    from rich.table import Table

    table = Table("least certain", "standard deviation of one frame, joints bent")
    turns = np.array(["_t" not in name[-3:] for name in found.dofs])
    sd = np.where(np.isfinite(found.typical_sd) & turns, found.typical_sd, -1.0)
    for i in np.argsort(-sd)[:WEAKEST_SHOWN]:
        table.add_row(found.dofs[i], f"{np.rad2deg(sd[i]):.1f}°")
    return table


def _overview(checks: list[ProtocolObservability]) -> Table:
    from rich.table import Table

    table = Table("protocol", "markers", "rank of H", "segments not fully determined")
    for check in checks:
        found = check.after
        segments = dict.fromkeys(
            name.rsplit("_", 1)[0] for name in found.unobserved + found.sometimes_unobserved
        )
        rank = f"{found.ranks.min()} of {len(found.dofs)}"
        blind = ", ".join(_both_sides(list(segments))) or "none"
        table.add_row(check.protocol.name, str(len(check.markers)), rank, blind)
    return table


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
