"""Import a marker set from an OpenSim model or marker set.

Reads OpenSim models (.osim, versions 2 to 4) and marker sets (MarkerSet .xml), also damaged ones, and moves their
markers to mbkf's body. A marker set does not hold the bones: those of OpenSim's common full-body model are taken.
Markers that OpenSim holds fixed become anatomical ones, the others technical ones, and those inside a joint computed
points.

Examples:
  mbkf protocol import model.osim --out my_markers.toml
  mbkf protocol import MarkerSet.xml                       (shows the set and writes nothing)
"""

from __future__ import annotations

import argparse

from mbkf.cli.options import add_out


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("file", metavar="FILE", help="OpenSim model (.osim) or marker set (.xml)")
    add_out(parser, "FILE.toml", "file to write (default: nothing is written)")


def run(args: argparse.Namespace) -> int:
    """Prints the marker set, and writes it."""
    from mbkf.cli.protocol import print_set
    from mbkf.cli.tables import terminal
    from mbkf.io.atomic import check_folder
    from mbkf.model.protocol_file import checked_name, write_protocol
    from mbkf.trial.protocol.from_osim import import_osim

    out = None if args.out is None else checked_name(args.out)
    if out is not None:
        check_folder(out.parent)
    found = import_osim(args.file)
    console = terminal()
    print_set(found.protocol, console)
    for name, move in found.moved.items():
        console.print(f"note: {name}: {move}, by its place", soft_wrap=True)
    if not found.with_skeleton:
        console.print("note: the file holds no bones; those of OpenSim's common full-body model were taken")
    markers = f"{len(found.protocol.markers)} markers, {len(found.computed)} of them computed points"
    if out is None:
        console.print(f"{args.file}: {markers}; --out FILE.toml writes the set", soft_wrap=True)
        return 0
    write_protocol(found.protocol, out)
    console.print(f"{out}: {markers}; look at it with 'mbkf protocol show {out}'", soft_wrap=True)
    return 0
