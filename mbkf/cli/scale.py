"""`mbkf scale`: fit the body to a person."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console

    from mbkf.io.subject import Subject

AUTO = "auto"
"""The mass is what the captures' plates tell."""

_EPILOG = """\
examples:
  mbkf scale static.trc --mass 85.07 --out subject.toml
  mbkf scale static.c3d --trial walk.c3d --mass 60 --height 1.72 --out subject.toml
  mbkf scale --trial walk.c3d --mass 63.6 --out subject.toml       (no static trial)
  mbkf scale static.c3d --trial walk.c3d --mass auto --out subject.toml  (weighed by the plates)
  mbkf scale static.c3d --trial walk.c3d --mass 60 --inertia --out subject.toml  (segments' masses by the plates)
  mbkf scale static.c3d --body legs.toml --mass 60 --out subject.toml  (a body of your own)
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the command to the command line."""
    from mbkf.cli.options import CAPTURE_FILES, add_axes_options

    parser = subparsers.add_parser(
        "scale",
        help="fit the body to a person, with the person's mass",
        description="Fit the body to a person: scale factors and marker positions from a standing trial, moving "
        "trials or both.",
        epilog=_EPILOG,
    )
    parser.add_argument("static", metavar="STATIC", nargs="?", help=f"standing trial ({CAPTURE_FILES})")
    parser.add_argument(
        "--trial", metavar="TRIAL", action="append", default=[], help="moving trial; may be repeated"
    )
    parser.add_argument(
        "--protocol",
        metavar="NAME|FILE",
        help="marker protocol; by default the shipped one that knows the names, else one inferred from the captures",
    )
    parser.add_argument(
        "--body", metavar="NAME|FILE", help="reference body; by default the one the protocol was written for"
    )
    parser.add_argument(
        "--mass",
        metavar="KG|auto",
        type=mass_option,
        help="body mass, or auto: what the captures' plates tell; by default what the capture states",
    )
    parser.add_argument("--height", metavar="M", type=float, help="body height, if known")
    parser.add_argument(
        "--inertia",
        action="store_true",
        help="find segments' masses and centres of mass by the captures' plates, and write them where the evidence "
        "is for them",
    )
    add_axes_options(parser)
    parser.add_argument("--out", required=True, metavar="SUBJECT.toml", help="file to write")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Scales and writes the subject, and prints how well it fits.

    Raises:
        MbkfError: An input is unusable.
    """
    from mbkf.cli.options import axes_options
    from mbkf.cli.progress import stages
    from mbkf.errors import FileFormatError, InvalidInput
    from mbkf.io.atomic import check_folder
    from mbkf.io.capture import read_capture
    from mbkf.io.subject import write_subject
    from mbkf.trial.inertia.estimate import with_inertia
    from mbkf.trial.scale import scale
    from mbkf.trial.weighing import PROVISIONAL_KG, weighed

    weighs = args.mass == AUTO
    if args.mass is not None and not weighs and not args.mass > 0:
        raise InvalidInput(f"--mass must be positive, got {args.mass:g}; give the body mass in kg")
    out = Path(args.out)
    if out.is_dir():
        raise FileFormatError(out, "is a folder; name a file for --out")
    check_folder(out.parent)
    static = None if args.static is None else read_capture(args.static, **axes_options(args))
    trials = [read_capture(path, **axes_options(args)) for path in args.trial]
    with stages() as report:
        subject = scale(
            static,
            trials,
            mass_kg=PROVISIONAL_KG if weighs else args.mass,
            height_m=args.height,
            protocol=args.protocol,
            body=args.body,
            progress=report,
        )
    if weighs:
        subject = weighed(subject, [*([] if static is None else [static]), *trials])
    if args.inertia:
        subject = with_inertia(subject, [*([] if static is None else [static]), *trials])
    write_subject(subject, out)
    warn_of_fit(subject)
    _print(subject.report, subject.protocol, str(out))
    warn_of_markers(subject)
    return 0


def mass_option(text: str) -> float | str:
    """A number of kg, or the word for what plates tell.

    Raises:
        ArgumentTypeError: It is neither.
    """
    if text == AUTO:
        return AUTO
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"invalid float value: '{text}'") from None


def warn_of_fit(subject: Subject) -> None:
    """Tells what speaks against the fitted body."""
    from mbkf.scaling.verdict import DOUBTS_KEY

    found = subject.report.get(DOUBTS_KEY)
    for doubt in found if isinstance(found, list) else ():
        print(f"warning: this body may not be the person's: {doubt}", file=sys.stderr)


def warn_of_markers(subject: Subject) -> None:
    """Tells an inferred set's doubts, exchanged names, and a protocol that knows too few of the person's markers."""
    from mbkf.trial.preparation.exchanged import exchange_notes
    from mbkf.trial.scale import EXCHANGED_KEY

    inferred = subject.report.get("inferred")
    for name, odds in inferred["doubtful"].items() if isinstance(inferred, dict) else ():
        told = ", ".join(f"{segment.replace('_', ' ')} {100 * share:.0f} %" for segment, share in odds)
        print(f"warning: marker {name} is doubtful: {told}", file=sys.stderr)
    exchanged = subject.report.get(EXCHANGED_KEY)
    for line in exchange_notes(exchanged) if isinstance(exchanged, list) else ():
        print(f"note: {line}", file=sys.stderr)
    use = subject.report.get("marker_use")
    if isinstance(use, dict) and use["warning"]:
        print(f"warning: {use['warning']}", file=sys.stderr)


def _use(use: dict[str, Any]) -> str:
    """How much the protocol knows, and which markers are ignored."""
    from mbkf.trial.preparation.coverage import listed

    ignored = use["ignored"]
    return f"{use['told']}; {len(ignored)} ignored" + (f": {listed(ignored)}" if ignored else "")


def _print(report: dict[str, Any], protocol: str, out: str) -> None:
    from rich.console import Console
    from rich.table import Table

    console = Console(highlight=False, markup=False)
    factors = Table(title="Scale factors", title_justify="left")
    for heading in ("factor", "value", "standard error"):
        factors.add_column(heading, justify="left" if heading == "factor" else "right")
    for name, entry in report["factors"].items():
        note = "  at its bound" if entry["at_bound"] else ""
        factors.add_row(
            name.replace("_", " "), f"{entry['value']:.3f}", f"{entry['standard_error']:.3f}{note}"
        )
    markers = Table(title="Markers that moved most from their reference place", title_justify="left")
    for heading in ("marker", "kind", "moved mm", "RMS mm", "max mm"):
        markers.add_column(heading, justify="left" if heading in ("marker", "kind") else "right")
    ranked = sorted(report["markers"].items(), key=lambda item: -item[1]["moved_mm"])
    for name, entry in [item for item in ranked if item[1]["kind"] in {"anatomical", "keypoint"}][:8]:
        numbers = (entry["moved_mm"], entry["rms_mm"], entry["max_mm"])
        markers.add_row(name, entry["kind"], *("" if x is None else f"{x:.1f}" for x in numbers))
    console.print(factors)
    console.print(markers)
    if "inferred" in report:
        console.print(f"note: {report['inferred']['told']}", soft_wrap=True)
    console.print(_use(report["marker_use"]), soft_wrap=True)
    if "mass" in report:
        by = report["mass"]
        line = f"mass {by['kg']:.1f} kg ± {2 * by['sd_percent']:.1f} % by the plates of {by['capture']}"
        console.print(line, soft_wrap=True)
    if "inertia" in report:
        _print_inertia(console, report["inertia"])
    for told in report.get("axes", ()):
        console.print(f"note: {told['capture']}: {told['note']}", soft_wrap=True)
    console.print(
        f"{out}: protocol {protocol}, {report['frames']} frames, markers fit to "
        f"{report['marker_rms_mm']:.1f} mm RMS",
        soft_wrap=True,
    )


def _print_inertia(console: Console, found: dict[str, Any]) -> None:
    """Prints segments' masses and centres with their standard deviations, and what speaks for them.

    Args:
        console: Where to.
        found: What the subject's report has of it.
    """
    from rich.table import Table

    if "segments" in found:
        table = Table(title="Segments by the plates, against the table", title_justify="left")
        for heading in ("segment", "mass %", "centre x mm", "centre y mm", "centre z mm"):
            table.add_column(heading, justify="left" if heading == "segment" else "right")
        for name, own in found["segments"].items():
            shifts = zip(own["centre_shift_mm"], own["centre_shift_sd_mm"], strict=True)
            cells = [f"{shift:+.0f} ± {sd:.0f}" for shift, sd in shifts]
            mass = f"{own['mass_percent']:+.0f} ± {own['mass_percent_sd']:.0f}"
            table.add_row(name.replace("_", " "), mass, *cells)
        console.print(table)
    console.print(found["told"], soft_wrap=True)
