"""Write a subject as URDF, MJCF or OSIM, a result as C3D, tables, BVH, GLB, film or a folder for OpenSim.

A subject:
  urdf  has no spherical joint: each becomes three hinges, named after the clinical angles (hip_flexion_r, …), whose
        positions in rad are those angles. The pelvis is the root link and floats; the reading program adds the free
        joint. Masses, inertias and markers are the subject's; boxes, cylinders and spheres draw the body.
        FILE.urdf.toml beside it holds roles, soles, landmarks and angles: 'mbkf scale --body FILE.urdf' reads both.
  mjcf  keeps ball joints and a free joint; otherwise the same.
  osim  a model of OpenSim 4 (y up) whose coordinates are the clinical angles, with its markers; its surfaces (VTP)
        stand beside it.

A result (a folder of 'mbkf reconstruct' or 'mbkf live', or its motion.h5):
  c3d   markers; under Plug-in Gait's names angles (deg), moments (Nm), powers (W), joint centres, reactions (N), the
        centre of mass, foot strikes and offs; plates of type 2; for Mokka, Visual3D, Nexus. With --trial, plates and
        analog channels (EMG) are the trial's, and loads that no plate reads are plates beside them.
  csv   a table, a row a frame: angles (deg), rates, moments, powers, standard deviations, loads, markers; the unit ends
        the name of each column; for pandas, R, spreadsheets.
  summary  key numbers for spreadsheets: a row of 52 columns, and all others in FILE_more.csv.
  v3d   Visual3D's text table of the same signals as the C3D file (m, deg, N m), which it adds to FILE.c3d.
  mjcf  the body, and its motion as key frames with positions and velocities.
  bids  a folder, Motion-BIDS: markers as measured, joint angles and foot events. Of a folder of results, all of them;
        --person states the label.
  bvh   rotations of the segments, cm, y up, z forward; for animation programs.
  glb   the moving body as 'mbkf view' draws it; m, y up; for animation programs and browsers.
  opensim  a folder: the model, its motion, the loads as ExternalLoads, set-ups for inverse dynamics and analyses:
        cd DIR; opensim-cmd run-tool setup_id.xml
  --onto MODEL.osim  a folder as well, for an OpenSim model of the person's size from elsewhere: the motion in its
        coordinates, fitted frame by frame, and set-ups for inverse dynamics, static optimisation, joint reactions,
        computed muscle control and Moco
  mp4, gif  a film of the 3-D view, 25 pictures a second. Needs Chromium, Chrome or Edge, and the extra 'film'.

Examples:
  mbkf export subject.toml --to urdf --out subject.urdf
  mbkf export subject.toml --to mjcf --out subject.xml     python -m mujoco.viewer --mjcf=subject.xml shows it
  mbkf export subject.toml --to osim --out subject.osim
  mbkf export result --to c3d --out walk_model.c3d
  mbkf export result --to c3d --trial walk.c3d --out walk_model.c3d
  mbkf export result --to csv --out walk.csv
  mbkf export result --to summary --out walk_summary.csv
  mbkf export result --to v3d --out walk_model.txt
  mbkf export result --to mjcf --out walk.xml
  mbkf export results --to bids --person 07 --out dataset
  mbkf export result --to bvh --out walk.bvh
  mbkf export result --to glb --out walk.glb
  mbkf export result --to opensim --out walk_opensim
  mbkf export result --onto scaled_rajagopal.osim --out walk_rajagopal
  mbkf export result --to mp4 --out walk.mp4
  mbkf export result --to gif --out walk.gif
"""

from __future__ import annotations

import argparse
from pathlib import Path

from mbkf.cli.options import add_out

_OF_SUBJECT, _FILMS = ("urdf", "mjcf", "osim"), ("mp4", "gif")
_OF_RESULT = ("c3d", "csv", "v3d", "summary", "mjcf", "bvh", "glb", "opensim", "bids", *_FILMS)
_FORMATS = tuple(dict.fromkeys((*_OF_SUBJECT, *_OF_RESULT)))


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument(
        "source", metavar="SUBJECT.toml|DIR", help="written by 'mbkf scale', or by 'mbkf reconstruct'"
    )
    parser.add_argument("--to", choices=_FORMATS, help="format")
    parser.add_argument("--onto", metavar="MODEL.osim", help="in place of --to: scaled model of OpenSim")
    parser.add_argument("--trial", metavar="FILE", help="c3d: the capture that the result was made from")
    parser.add_argument("--forces", metavar="FILE", help="c3d: ground reactions that it was made with")
    parser.add_argument(
        "--person", metavar="LABEL", help="bids: label of the person, letters and digits (01)"
    )
    add_out(parser, "FILE|DIR", "file to write; for opensim, --onto and bids the folder", required=True)


def run(args: argparse.Namespace) -> int:
    """Writes the file.

    Raises:
        InvalidInput: The format is for subjects and the source a result, or the other way round; or an option belongs
            to another format.
    """
    from mbkf.io.atomic import check_file
    from mbkf.io.results_folder import read_blocks, read_reconstruction
    from mbkf.io.subject import read_subject
    from mbkf.trial.exchange.result_bids import write_results_bids
    from mbkf.trial.exchange.result_csv import write_csv
    from mbkf.trial.export import export_result, export_subject

    source, out = Path(args.source), Path(args.out)
    is_result = source.is_dir() or source.suffix.lower() in {".h5", ".hdf5"}
    _check(args, source, is_result)
    beside = _beside(args.to, out)
    for path in beside:
        check_file(path)
    if args.onto:
        return _onto(args, source)
    if args.to in _FILMS:
        from mbkf.cli.progress import stages
        from mbkf.viz.film.film import write_film

        result = read_reconstruction(source)
        with stages() as report:
            write_film(result, args.to, out, progress=report)
    elif args.to == "bids":
        write_results_bids([read_reconstruction(one) for one in _results(source)], out, args.person or "01")
    elif is_result and args.to == "csv":
        write_csv(read_blocks(source), out)
    elif is_result:
        export_result(read_reconstruction(source), args.to, out, trial=args.trial, forces=args.forces)
    else:
        export_subject(read_subject(source), args.to, out)
    for path in (out, *beside):
        print(path)
    return 0


def _check(args: argparse.Namespace, source: Path, is_result: bool) -> None:
    """Refuses a format for sources of the other kind, and options of other formats."""
    from mbkf.errors import InvalidInput

    if bool(args.to) == bool(args.onto):
        raise InvalidInput("give a format by --to, or a model of OpenSim by --onto MODEL.osim: one of them")
    if args.onto and not is_result:
        raise InvalidInput(
            f"{source} is no result: --onto exports a result's motion; name the folder that 'mbkf reconstruct' wrote"
        )
    formats = _OF_RESULT if is_result else _OF_SUBJECT
    if args.to and args.to not in formats:
        found, other = ("a result", "subjects") if is_result else ("the file of a subject", "results")
        hint = "the subject file of 'mbkf scale'" if is_result else "the folder of 'mbkf reconstruct'"
        raise InvalidInput(
            f"{source} is {found}, and {args.to} is a format for {other}: name {hint}, or choose "
            f"--to {' or '.join(formats)}"
        )
    if (args.trial or args.forces) and args.to != "c3d":
        raise InvalidInput(f"--trial and --forces are of --to c3d; leave them out for {args.to or '--onto'}")
    if args.forces and not args.trial:
        raise InvalidInput("--forces belongs to a trial; name its file with --trial")
    if args.person and args.to != "bids":
        raise InvalidInput(f"--person is of --to bids; leave it out for {args.to or '--onto'}")


def _onto(args: argparse.Namespace, source: Path) -> int:
    """Writes the folder for a model of OpenSim, and shows the distances that remain."""
    from mbkf.cli.tables import table, terminal
    from mbkf.io.results_folder import read_reconstruction
    from mbkf.trial.exchange.onto.result_onto import export_onto

    found = export_onto(read_reconstruction(source), args.onto, args.out)
    shown = table("", "segment", "body", "placed by", "place mm", "turn °", words=3)
    for one in found.residuals:
        count = len(one.pair.markers)
        by = f"{count} markers" if count else "joints"
        shown.add_row(one.pair.segment, one.pair.body, by, f"{one.place_mm:.1f}", f"{one.turn_deg:.1f}")
    terminal().print(shown)
    if found.markers:
        print(
            f"{len(found.markers)} markers in common: {found.to_measured_mm:.1f} mm RMS from the measured ones, "
            f"{found.to_ours_mm:.1f} mm from those of the reconstructed body"
        )
    for name, share in found.limited.items():
        print(f"note: {name} is at a limit of the model in {100.0 * share:.0f} % of the frames")
    print(args.out)
    return 0


def _beside(kind: str, out: Path) -> tuple[Path, ...]:
    """The file that a format writes beside that of ``--out``."""
    from mbkf.model.urdf_body import side_path
    from mbkf.trial.exchange.summary_table import more_path

    return {"urdf": (side_path(out),), "summary": (more_path(out),)}.get(kind, ())


def _results(source: Path) -> list[Path]:
    """The result, or those in a folder of results, in the order of their names."""
    from mbkf.io.results_folder import MOTION_FILE

    if not source.is_dir() or (source / MOTION_FILE).exists():
        return [source]
    return sorted(path.parent for path in source.glob(f"*/{MOTION_FILE}")) or [source]
