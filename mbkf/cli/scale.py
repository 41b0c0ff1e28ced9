"""Fit the body to a person, with the person's mass.

Fits scale factors and marker positions to a standing trial, moving trials or both. Of a session's folder it takes
standing and those of the other trials that help: a walk, a deep flexion (squat, sit-to-stand), a movement of the arms.

Examples:
  mbkf scale P01/monday --mass 85.07 --out subject.toml        (a session's folder; it chooses the trials)
  mbkf scale static.trc --mass 85.07 --out subject.toml
  mbkf scale static.trc --trial walk.trc --trial squat.trc --mass 85.07 --out subject.toml
  mbkf scale static.c3d --trial walk.c3d --mass 60 --height 1.72 --out subject.toml
  mbkf scale --trial walk.c3d --mass 63.6 --out subject.toml       (no static trial)
  mbkf scale static.c3d --trial walk.c3d --mass auto --out subject.toml  (weighed by the plates)
  mbkf scale static.c3d --mass auto --without-plate 2 --out subject.toml  (one of them broken)
  mbkf scale static.trc --trial walk.trc --forces walk.mot --mass auto --out subject.toml
  mbkf scale static.c3d --trial walk.c3d --mass 60 --inertia --out subject.toml  (masses of segments by the plates)
  mbkf scale static.c3d --body legs.toml --mass 60 --out subject.toml  (a body of your own)
  mbkf scale static.c3d --body robot.urdf --mass 60 --out subject.toml  (from URDF, with robot.urdf.toml)
  mbkf scale static.c3d --body leg.osim --protocol leg.osim --out subject.toml    (from OpenSim, with leg.osim.toml)
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mbkf.cli.options import (
    CAPTURE_FILES,
    FORCE_FILES,
    add_axes_options,
    add_out,
    add_static_only,
    add_without_plate,
    axes_options,
    body_mass,
)
from mbkf.cli.tables import table, terminal
from mbkf.numerics.printed import percent, rounded

if TYPE_CHECKING:
    from rich.console import Console

    from mbkf.io.records import Capture
    from mbkf.io.subject import Subject
    from mbkf.scaling.records import ScalingSettings

AUTO = "auto"
"""The mass as the captures' plates weigh it."""

SCALINGS = ("own", "thesis")

MOST_MARKERS = 8
"""Markers that the table shows."""


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument(
        "static",
        metavar="STATIC|FOLDER",
        nargs="?",
        help=f"standing trial ({CAPTURE_FILES}), or a session's folder",
    )
    parser.add_argument(
        "--trial",
        metavar="TRIAL",
        action="append",
        default=[],
        help="moving trial; may be repeated; beside a folder in place of the trials that would be chosen",
    )
    parser.add_argument(
        "--forces",
        metavar="FILE",
        action="append",
        default=[],
        help=f"ground reactions ({FORCE_FILES}) of the trials other than C3D, in their order; may be repeated",
    )
    add_static_only(parser)
    parser.add_argument(
        "--protocol",
        metavar="NAME|FILE",
        help="marker protocol (default: the shipped one that knows the names, else one inferred from the captures)",
    )
    parser.add_argument(
        "--body", metavar="NAME|FILE", help="reference body (default: the one of the protocol)"
    )
    parser.add_argument(
        "--mass",
        metavar="KG|auto",
        type=mass_option,
        help="body mass, or auto: as the captures' plates weigh it (default: as the capture states)",
    )
    parser.add_argument("--height", metavar="M", type=float, help="body height, if known")
    parser.add_argument(
        "--scaling",
        choices=SCALINGS,
        default=SCALINGS[0],
        help="factors of the body: its own, or the thesis's, whose pelvis and torso share a vertical one "
        "(default: %(default)s)",
    )
    parser.add_argument(
        "--keep-names",
        action="store_true",
        help="keep the static trial's names, even where exchanged ones fit the body better",
    )
    parser.add_argument(
        "--inertia",
        action="store_true",
        help="estimate masses and centres of mass of segments from the plates, and write them if the evidence supports "
        "them",
    )
    add_without_plate(parser)
    add_axes_options(parser)
    add_out(parser, "SUBJECT.toml", "file to write", required=True)


def run(args: argparse.Namespace) -> int:
    """Scales and writes the subject, and prints the quality of the fit."""
    from mbkf.errors import FileFormatError
    from mbkf.io.atomic import check_folder
    from mbkf.io.subject import write_subject
    from mbkf.study.scaling.report import bends_deeply
    from mbkf.trial.hip_centres import hip_note

    out = Path(args.out)
    if out.is_dir():
        raise FileFormatError(out, "is a folder; name a file for --out")
    check_folder(out.parent)
    folder = args.static is not None and _is_session(Path(args.static))
    subject = _of_folder(args) if folder else _of_captures(args, args.static, _stated(args))
    write_subject(subject, out)
    warn_of_fit(subject)
    advice = "" if args.trial or bends_deeply(subject.report) else hip_note(subject)
    _print(subject.report, subject.protocol, str(out), advice)
    warn_of_markers(subject)
    return 0


def _is_session(path: Path) -> bool:
    """A folder that is not named as a capture."""
    from mbkf.io.capture import folder_suffixes

    return path.is_dir() and path.suffix.lower() not in folder_suffixes()


def _stated(args: argparse.Namespace) -> dict[str, Any]:
    """Facts about the person among the options."""
    from mbkf.trial.weighing import PROVISIONAL_KG

    mass_kg = PROVISIONAL_KG if args.mass == AUTO else args.mass
    stated = {"mass_kg": mass_kg, "height_m": args.height, "protocol": args.protocol}
    return {name: value for name, value in stated.items() if value is not None}


def _of_captures(args: argparse.Namespace, standing: str | Path | None, stated: dict[str, Any]) -> Subject:
    """The person of a standing trial and the moving ones named."""
    from mbkf.cli.force_files import forces_of_person
    from mbkf.cli.progress import stages
    from mbkf.trial.scale import scale

    read = _Reader(args)
    own, others = forces_of_person(None if standing is None else str(standing), args.trial, args.forces)
    static = None if standing is None else read(standing, forces=own)
    trials = [read(path, forces=forces) for path, forces in zip(args.trial, others, strict=True)]
    read.check()
    with stages() as report:
        subject = scale(static, trials, **stated, body=args.body, settings=_settings(args), progress=report)
    return _weighed(args, subject, trials if static is None else [static, *trials])


def _of_folder(args: argparse.Namespace) -> Subject:
    """The person of a session's folder, from the trials named or those that are chosen."""
    from mbkf.cli.progress import stages
    from mbkf.errors import InvalidInput
    from mbkf.study.batch.folder import person_of_folder
    from mbkf.study.batch.person import captures_used, scaled
    from mbkf.study.batch.sorting import one_person

    person = replace(person_of_folder(Path(args.static)), **_stated(args))
    read = _Reader(args)
    if person.unsorted:
        person = one_person(person, read)
    if args.trial:
        stated = {name: getattr(person, name) for name in ("mass_kg", "height_m", "protocol")}
        return _of_captures(args, next(iter(person.statics), None), stated)
    if args.forces:
        raise InvalidInput(
            "--forces belongs to trials that are named; name them with --trial, or lay the file beside its trial"
        )
    person = replace(person, static_only=args.static_only or person.static_only)
    with stages() as report:
        subject = scaled(person, report, body=args.body, settings=_settings(args), read=read)
    read.check()
    needs_plates = args.inertia or args.mass == AUTO
    return _weighed(args, subject, captures_used(person, subject, read) if needs_plates else ())


class _Reader:
    """Reads captures as the options say, without the plates withheld, each of which some capture has to have."""

    def __init__(self, args: argparse.Namespace) -> None:
        self._withheld, self._axes = tuple(args.without_plate), axes_options(args)
        self._known: dict[str, None] = {}

    def __call__(self, path: str | Path, **more: Any) -> Capture:
        """The capture; ``more`` are other arguments of the reader."""
        from mbkf.io.capture import read_capture
        from mbkf.trial.preparation.selection import plate_names, without_plates

        capture = read_capture(path, unneeded_plates=self._withheld, **self._axes, **more)
        known = plate_names(capture)
        self._known |= dict.fromkeys(known)
        return without_plates(capture, [name for name in self._withheld if name in known])

    def check(self) -> None:
        """Refuses a plate that no capture has."""
        from mbkf.trial.preparation.selection import check_withheld

        check_withheld(self._known, self._withheld)


def _settings(args: argparse.Namespace) -> ScalingSettings:
    from mbkf.scaling.records import ScalingSettings

    return ScalingSettings(thesis_factors=args.scaling == "thesis", correct_names=not args.keep_names)


def _weighed(args: argparse.Namespace, subject: Subject, captures: Sequence[Capture]) -> Subject:
    """The person with mass and inertia by the plates of the captures, as far as they are asked for."""
    from mbkf.trial.inertia.estimate import with_inertia
    from mbkf.trial.weighing import weighed

    if args.mass == AUTO:
        subject = weighed(subject, captures)
    return with_inertia(subject, captures) if args.inertia else subject


def mass_option(text: str) -> float | str:
    """A body mass in kg, or ``auto``."""
    return AUTO if text == AUTO else body_mass(text)


def warn_of_fit(subject: Subject) -> None:
    """Prints the evidence against the fitted body, and of plates against its mass."""
    from mbkf.scaling.verdict import DOUBTS_KEY
    from mbkf.trial.checks.unscaled_mass import PLATES_KEY

    contradictions = subject.report.get(PLATES_KEY)
    for note in contradictions if isinstance(contradictions, list) else ():
        print(f"warning: {note}", file=sys.stderr)
    found = subject.report.get(DOUBTS_KEY)
    for doubt in found if isinstance(found, list) else ():
        print(f"warning: this body may not be the person's: {doubt}", file=sys.stderr)


def warn_of_markers(subject: Subject) -> None:
    """Prints an inferred set's doubts, exchanged names, and a protocol that knows too few of the person's markers."""
    from mbkf.io.static_exchanges import static_exchanges
    from mbkf.trial.preparation.exchanged import EXCHANGED_KEY, exchange_notes
    from mbkf.trial.preparation.static_names import static_exchange_note

    inferred = subject.report.get("inferred")
    for name, odds in inferred["doubtful"].items() if isinstance(inferred, dict) else ():
        segments = ", ".join(f"{segment.replace('_', ' ')} {percent(share)}" for segment, share in odds)
        print(f"warning: the segment of marker {name} is uncertain: {segments}", file=sys.stderr)
    of_static = static_exchange_note(static_exchanges(subject))
    if of_static:
        print(f"warning: {of_static}", file=sys.stderr)
    exchanged = subject.report.get(EXCHANGED_KEY)
    for line in exchange_notes(exchanged) if isinstance(exchanged, list) else ():
        print(f"note: {line}", file=sys.stderr)
    use = subject.report.get("marker_use")
    if isinstance(use, dict) and use["warning"]:
        print(f"warning: {use['warning']}", file=sys.stderr)


def _print(report: dict[str, Any], protocol: str, out: str, advice: str) -> None:
    from mbkf.scaling.verdict import APPROXIMATED_KEY
    from mbkf.study.scaling.report import scaled_from
    from mbkf.trial.preparation.coverage import listed

    console = terminal()
    factors = table("Scale factors", "factor", "value", "standard error")
    for name, entry in report["factors"].items():
        note = "  at its bound" if entry["at_bound"] else ""
        factors.add_row(
            name.replace("_", " "), f"{entry['value']:.3f}", f"{entry['standard_error']:.3f}{note}"
        )
    console.print(factors)
    title = "Markers that moved most from their reference place"
    markers = table(title, "marker", "kind", "moved mm", "RMS mm", "max mm", words=2)
    ranked = sorted(report["markers"].items(), key=lambda item: -item[1]["moved_mm"])
    for name, entry in [item for item in ranked if item[1]["kind"] in {"anatomical", "keypoint"}][
        :MOST_MARKERS
    ]:
        numbers = (entry["moved_mm"], entry["rms_mm"], entry["max_mm"])
        markers.add_row(name, entry["kind"], *("" if x is None else f"{x:.1f}" for x in numbers))
    console.print(markers)
    if "inferred" in report:
        console.print(f"note: {report['inferred']['told']}", soft_wrap=True)
    use = report["marker_use"]
    if "inferred" not in report or use["joined"]:
        names = f": {listed(use['ignored'])}" if use["ignored"] else ""
        console.print(f"{use['told']}; {len(use['ignored'])} ignored{names}", soft_wrap=True)
    if "mass" in report:
        by = report["mass"]
        line = f"mass {by['kg']:.1f} kg ± {2 * by['sd_percent']:.1f} % by the plates of {by['capture']}"
        console.print(line, soft_wrap=True)
    if "inertia" in report:
        _print_inertia(console, report["inertia"])
    for line in scaled_from(report):
        console.print(line, soft_wrap=True)
    for found in report.get(APPROXIMATED_KEY, ()):
        console.print(f"note: {found}", soft_wrap=True)
    for found in report.get("axes", ()):
        console.print(f"note: {found['capture']}: {found['note']}", soft_wrap=True)
    if advice:
        console.print(f"note: {advice}", soft_wrap=True)
    console.print(
        f"{out}: protocol {protocol}, {report['frames']} frame{'s' if report['frames'] > 1 else ''}, markers fit to "
        f"{report['marker_rms_mm']:.1f} mm RMS",
        soft_wrap=True,
    )


def _print_inertia(console: Console, found: dict[str, Any]) -> None:
    """Prints masses and centres of segments with their standard deviations, and the evidence for them."""
    if "segments" in found:
        title = "Segments by the plates, against the table"
        shown = table(title, "segment", "mass %", "centre x mm", "centre y mm", "centre z mm")
        for name, own in found["segments"].items():
            shifts = zip(own["centre_shift_mm"], own["centre_shift_sd_mm"], strict=True)
            cells = [f"{rounded(shift, signed=True)} ± {rounded(sd)}" for shift, sd in shifts]
            mass = f"{rounded(own['mass_percent'], signed=True)} ± {rounded(own['mass_percent_sd'])}"
            shown.add_row(name.replace("_", " "), mass, *cells)
        console.print(shown)
    console.print(found["told"], soft_wrap=True)
