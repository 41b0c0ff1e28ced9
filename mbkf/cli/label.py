"""Name the points of an unlabelled capture.

Names the points by the subject's marker geometry and a filter's prediction. Points may be shuffled in every frame or
come as tracks; points that belong to no marker are dropped. Names that the capture has and the subject knows are kept
unless they jump from frame to frame or contradict the body; without a subject or a standing trial they are ignored.

Examples:
  mbkf label raw.c3d --subject subject.toml --out trial.c3d
  mbkf label raw.trc --subject subject.toml --out trial.trc
  mbkf label walk7/raw.c3d --subject walk7/subject.toml --truth walk7/trial.c3d --out labelled.c3d
  mbkf label raw.c3d --static standing.c3d --mass 71 --out trial.c3d       (scales from the labelled standing trial)
  mbkf label raw.c3d --protocol autolabel62 --mass 75 --out trial.c3d      (a person who is not scaled yet)
  mbkf label raw.c3d --mass 75 --out trial.c3d                             (and whose marker set is inferred)

The printed numbers also go to FILE.json. A person scaled on the way is written to FILE.toml, for 'mbkf reconstruct
--subject'. Warnings name labels that may be wrong: another name fits nearly as well, or the marker is not at its place.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from mbkf.cli.options import CAPTURE_FILES, add_axes_options, add_out, axes_options, body_mass
from mbkf.numerics.printed import percent

if TYPE_CHECKING:
    from mbkf.conventions import StageCallback
    from mbkf.io.records import Capture
    from mbkf.io.subject import Subject
    from mbkf.trial.labelling.result import Labelling, LabelSummary


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("raw", metavar="RAW", help=f"capture ({CAPTURE_FILES}) with unnamed points")
    parser.add_argument(
        "--ignore-names",
        action="store_true",
        help="ignore the capture's names, of which those that stay on their points and fit the body are kept otherwise",
    )
    parser.add_argument("--subject", metavar="SUBJECT.toml", help="written by 'mbkf scale'")
    parser.add_argument(
        "--static", metavar="LABELLED", help="instead of --subject: a labelled standing trial to scale from"
    )
    parser.add_argument(
        "--protocol",
        metavar="NAME|FILE",
        help="marker protocol; without --subject and --static the person is scaled from the capture itself",
    )
    parser.add_argument(
        "--mass",
        metavar="KG",
        type=body_mass,
        help="body mass of a person to scale (default: as the capture states)",
    )
    parser.add_argument("--height", metavar="M", type=float, help="body height of a person to scale")
    parser.add_argument("--truth", metavar="LABELLED.c3d", help="the same trial with labels, for comparison")
    add_axes_options(parser)
    add_out(parser, "FILE.c3d|FILE.trc", "file to write", required=True)


def run(args: argparse.Namespace) -> int:
    """Labels the capture, writes it with its summary and prints the numbers."""
    from mbkf.cli.progress import stages
    from mbkf.io.atomic import check_file
    from mbkf.io.atomic_folder import replacing_beside
    from mbkf.io.capture import read_capture
    from mbkf.io.subject import write_subject
    from mbkf.trial.axes.captures import turned_like_subject
    from mbkf.trial.labelling.files import write_labels
    from mbkf.trial.labelling.score import score

    out = _checked(Path(args.out))
    for beside in (".json", *((".toml",) if args.subject is None else ())):
        check_file(out.with_suffix(beside))
    _check_person(args)
    raw = read_capture(args.raw, **axes_options(args))
    truth = None if args.truth is None else read_capture(args.truth, **axes_options(args))
    with stages() as report:
        found, subject, raw = _label(args, raw, report)
    truth = None if truth is None else turned_like_subject(truth, subject)
    compared = None if truth is None else score(found.markers, truth.markers, subject)
    with replacing_beside(out) as partial:
        summary = write_labels(raw, found, partial / out.name, compared)
        if args.subject is None:
            write_subject(subject, partial / out.with_suffix(".toml").name)
    print_labels(summary, out)
    for warning in () if found.doubts is None else found.doubts.warnings():
        print(f"warning: {warning}", file=sys.stderr)
    if found.others_remark:
        print(f"warning: {found.others_remark}", file=sys.stderr)
    if args.subject is None:
        print(
            f"{out.with_suffix('.toml')}: the scaled person, markers fit to "
            f"{subject.report['marker_rms_mm']:.1f} mm RMS"
        )
    return 0


def _label(
    args: argparse.Namespace, raw: Capture, report: StageCallback
) -> tuple[Labelling, Subject, Capture]:
    """The labels, the person that they were found with, and the capture in the axes of that person."""
    from mbkf.cli.scale import warn_of_markers
    from mbkf.io.capture import read_capture
    from mbkf.io.subject import read_subject
    from mbkf.trial.axes.captures import turned_like_subject
    from mbkf.trial.label import label
    from mbkf.trial.label_nameless import label_nameless
    from mbkf.trial.label_unscaled import label_unscaled
    from mbkf.trial.scale import scale

    person = {"mass_kg": args.mass, "height_m": args.height}
    if args.subject is not None:
        subject = read_subject(args.subject)
    elif args.static is not None:
        static = read_capture(args.static, **axes_options(args))
        subject = scale(static, protocol=args.protocol, progress=report, **person)
        warn_of_markers(subject)
    elif args.protocol is not None:
        return *label_unscaled(raw, args.protocol, progress=report, **person), raw
    else:
        found, subject, inferred = label_nameless(raw, progress=report, **person)
        print(f"note: {inferred.line}")
        return found, subject, inferred.captures[0]
    raw = turned_like_subject(raw, subject)
    return label(raw, subject, ignore_names=args.ignore_names, progress=report), subject, raw


def _check_person(args: argparse.Namespace) -> None:
    """Refuses options that contradict each other."""
    from mbkf.errors import InvalidInput

    if args.subject is None and args.static is None and args.protocol is None and args.truth is not None:
        raise InvalidInput("--truth: an inferred marker set has its own names; add --protocol or --subject")
    for name in ("static", "protocol", "mass", "height") if args.subject is not None else ():
        if getattr(args, name) is not None:
            raise InvalidInput(
                f"--{name} is for a person to scale, and --subject names a scaled one; give one"
            )


def _checked(out: Path) -> Path:
    from mbkf.errors import FileFormatError, InvalidInput
    from mbkf.io.capture import writable_suffixes
    from mbkf.io.readers import either

    if out.suffix.lower() not in writable_suffixes():
        raise InvalidInput(f"--out {out}: name a {either(writable_suffixes())} file")
    if out.is_dir():
        raise FileFormatError(out, "is a folder; name a file for --out")
    return out


def print_labels(summary: LabelSummary, out: Path) -> None:
    """Prints the counts, and the shares of right and wrong names where the truth is known."""
    print(
        f"{out}: {summary['markers']} markers in {summary['frames']} frames, "
        f"{percent(summary['assigned_fraction'], 2)} of marker-frames assigned, "
        f"{summary['ghosts_dropped']} ghost points dropped, {summary['swaps_repaired']} swaps repaired, "
        f"first labelled frame {summary['first_labelled_frame']}"
    )
    if "correct_fraction" in summary:
        print(
            f"against the truth: {percent(summary['correct_fraction'], 3)} correct, "
            f"{percent(summary['wrong_fraction'], 3)} wrong, {percent(summary['missed_fraction'], 3)} missed"
        )
