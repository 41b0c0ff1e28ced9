"""`mbkf export`: a scaled subject for robotics tools and MuJoCo, or a result for laboratories and animation."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from pathlib import Path

from mbkf.errors import InvalidInput

_OF_SUBJECT, _OF_RESULT, _FILMS = ("urdf", "mjcf"), ("c3d", "bvh", "glb", "mp4", "gif"), ("mp4", "gif")

_EPILOG = """\
A subject:
  urdf  has no spherical joint: each becomes three hinges, named after the clinical angles (hip_flexion_r, …), whose
        positions in rad are those angles. The pelvis is the root link and floats; the reading program adds the free
        joint. Masses, inertias and markers are the subject's.
  mjcf  keeps ball joints and a free joint; otherwise the same.
A result (a folder of 'mbkf reconstruct' or 'mbkf live', or its motion.h5):
  c3d   markers, and as Plug-in Gait names them angles (deg), moments (Nm), powers (W), joint centres, reactions (N),
        the centre of mass, foot strikes and offs; for Mokka, Visual3D, Nexus.
  bvh   the segments' rotations, cm, y up, z forward; for animation programs.
  glb   the body as 'mbkf view' draws it, moving; m, y up; for animation programs and browsers.
  mp4, gif  a film of the 3-D view, 25 pictures a second. Needs Chromium, Chrome or Edge, and pip install av playwright.

examples:
  mbkf export subject.toml --to urdf --out subject.urdf
  mbkf export subject.toml --to mjcf --out subject.xml     python -m mujoco.viewer --mjcf=subject.xml shows it
  mbkf export result --to c3d --out walk_model.c3d
  mbkf export result --to bvh --out walk.bvh
  mbkf export result --to glb --out walk.glb
  mbkf export result --to mp4 --out walk.mp4
  mbkf export result --to gif --out walk.gif
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the command to the command line."""
    parser = subparsers.add_parser(
        "export",
        help="write a subject as URDF or MJCF, a result as C3D, BVH, GLB or film",
        description="Write a scaled subject or a result as a file of other programs.",
        epilog=_EPILOG,
    )
    parser.add_argument(
        "source", metavar="SUBJECT.toml|DIR", help="written by 'mbkf scale', or by 'mbkf reconstruct'"
    )
    parser.add_argument("--to", required=True, choices=(*_OF_SUBJECT, *_OF_RESULT), help="format")
    parser.add_argument("--out", required=True, metavar="FILE", help="file to write")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Writes the file.

    Raises:
        FileFormatError: Subject or result cannot be read, or a folder stands where the file is needed.
        InvalidInput: A result is asked for a format of subjects, or the other way round; it holds no motion; or no
            browser draws its film.
        MissingDependency: A library that films need is not installed.
        UnknownName: The subject's body or a marker's segment is unknown.
    """
    source = Path(args.source)
    if _is_result(source):
        _require(args, _OF_RESULT, "a result", "a subject", "the subject file that 'mbkf scale' wrote")
        _export_result(source, args.to, args.out)
    else:
        _require(
            args, _OF_SUBJECT, "a file of a subject", "a result", "the folder that 'mbkf reconstruct' wrote"
        )
        from mbkf.io.subject import read_subject
        from mbkf.trial.export import export_subject

        export_subject(read_subject(source), args.to, args.out)
    print(args.out)
    return 0


def _export_result(source: Path, kind: str, out: str) -> None:
    from mbkf.io.results_folder import read_reconstruction

    result = read_reconstruction(source)
    if kind in _FILMS:
        from mbkf.cli.progress import stages
        from mbkf.viz.film.film import write_film

        with stages() as report:
            write_film(result, kind, out, progress=report)
        return
    from mbkf.trial.export import export_result

    export_result(result, kind, out)


def _is_result(source: Path) -> bool:
    """A folder, or a file named as motion.h5 is."""
    return source.is_dir() or source.suffix.lower() in {".h5", ".hdf5"}


def _require(args: argparse.Namespace, formats: Iterable[str], found: str, needed: str, hint: str) -> None:
    """Refuses a format that is not one of what was found.

    Args:
        args: The command's.
        formats: Those of what was found.
        found: What that is.
        needed: What the format is for.
        hint: Where that is found.
    """
    if args.to not in formats:
        raise InvalidInput(
            f"{args.source} is {found}, and {args.to} is a format for {needed}: name {hint}, "
            f"or choose --to {' or '.join(formats)}"
        )
