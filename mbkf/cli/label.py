"""`mbkf label`: names for the points of an unlabelled capture."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

_EPILOG = """\
examples:
  mbkf label raw.c3d --subject subject.toml --out trial.c3d
  mbkf label raw.trc --subject subject.toml --out trial.trc
  mbkf label walk7/raw.c3d --subject walk7/subject.toml --truth walk7/trial.c3d --out labelled.c3d

Points may be shuffled in every frame or come as tracks. Points that are no marker are dropped. The numbers that are
printed also go to FILE.json.
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the command to the command line."""
    parser = subparsers.add_parser(
        "label",
        help="unlabelled points to named markers",
        description="Name the points of a capture by the subject's marker geometry and a filter's prediction.",
        epilog=_EPILOG,
    )
    parser.add_argument("raw", metavar="RAW", help="unlabelled capture (.c3d or .trc); its names are ignored")
    parser.add_argument("--subject", required=True, metavar="SUBJECT.toml", help="written by 'mbkf scale'")
    parser.add_argument("--truth", metavar="LABELLED.c3d", help="the same trial with labels, to compare with")
    parser.add_argument("--up", metavar="AXIS", help="axis of the file that points up: x, y, z, -x, -y or -z")
    parser.add_argument("--unit", metavar="UNIT", help="length unit of the file: mm, cm or m")
    parser.add_argument("--out", required=True, metavar="FILE.c3d|FILE.trc", help="file to write")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Labels the capture, writes it with its summary and prints the numbers.

    Raises:
        MbkfError: An input is unusable.
    """
    from mbkf.cli.progress import stages
    from mbkf.io.atomic import check_folder, replacing
    from mbkf.io.c3d_write import write_c3d
    from mbkf.io.capture import read_capture
    from mbkf.io.subject import read_subject
    from mbkf.io.trc import write_trc
    from mbkf.pipelines.label import label, labelled_capture, summarise
    from mbkf.pipelines.label_score import score

    out = _checked(Path(args.out), Path(args.raw))
    check_folder(out.parent)
    subject = read_subject(args.subject)
    raw = read_capture(args.raw, up=args.up, unit=args.unit)
    truth = None if args.truth is None else read_capture(args.truth, up=args.up, unit=args.unit)
    with stages() as report:
        found = label(raw, subject, progress=report)
    compared = None if truth is None else score(found.markers, truth.markers, subject)
    summary = summarise(found, compared)
    labelled = labelled_capture(raw, found)
    if out.suffix.lower() == ".trc":
        write_trc(labelled.markers, out)
    else:
        write_c3d(labelled, out)
    with replacing(out.with_suffix(".json")) as partial:
        partial.write_text(json.dumps(summary, indent=2) + "\n", encoding="utf-8")
    _print(summary, out)
    return 0


def _checked(out: Path, raw: Path) -> Path:
    from mbkf.errors import FileFormatError, InvalidInput

    if out.suffix.lower() not in (".c3d", ".trc"):
        raise InvalidInput(f"--out {out}: name a .c3d or .trc file")
    if out.is_dir():
        raise FileFormatError(out, "is a folder; name a file for --out")
    if out.resolve() == raw.resolve():
        raise InvalidInput(f"--out {out}: is the raw capture itself; name another file")
    return out


def _print(summary: dict[str, Any], out: Path) -> None:
    print(
        f"{out}: {summary['markers']} markers in {summary['frames']} frames, "
        f"{100 * summary['assigned_fraction']:.2f} % of marker-frames assigned, "
        f"{summary['ghosts_dropped']} ghost points dropped, {summary['swaps_repaired']} swaps repaired, "
        f"first labelled frame {summary['first_labelled_frame']}"
    )
    if "correct_fraction" in summary:
        print(
            f"against the truth: {100 * summary['correct_fraction']:.3f} % correct, "
            f"{100 * summary['wrong_fraction']:.3f} % wrong, {100 * summary['missed_fraction']:.3f} % missed"
        )
