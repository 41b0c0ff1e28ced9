"""`mbkf export`: a scaled subject for robotics tools (URDF) or MuJoCo (MJCF)."""

from __future__ import annotations

import argparse

_EPILOG = """\
URDF has no spherical joint: each becomes three hinges, named after the clinical angles (hip_flexion_r, …),
whose positions in rad are those angles. The pelvis is the root link and floats; the reading program adds the
free joint.
MJCF keeps ball joints and a free joint. Both carry the masses, inertias and markers of the subject.

examples:
  mbkf export subject.toml --to urdf --out subject.urdf
  mbkf export subject.toml --to mjcf --out subject.xml     python -m mujoco.viewer --mjcf=subject.xml shows it
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the command to the command line."""
    parser = subparsers.add_parser(
        "export",
        help="write a scaled subject as URDF or MJCF",
        description="Write a scaled subject as a model file of another program.",
        epilog=_EPILOG,
    )
    parser.add_argument("subject", metavar="SUBJECT.toml", help="the subject, written by 'mbkf scale'")
    parser.add_argument("--to", required=True, choices=("urdf", "mjcf"), help="format")
    parser.add_argument("--out", required=True, metavar="FILE", help="file to write")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Writes the file.

    Raises:
        FileFormatError: The subject cannot be read, or a folder stands where the file is needed.
        UnknownName: The subject's body or a marker's segment is unknown.
    """
    from mbkf.io.subject import read_subject
    from mbkf.pipelines.export import export_subject

    export_subject(read_subject(args.subject), args.to, args.out)
    print(args.out)
    return 0
