"""Reconstruct motion, torques and reactions from markers and plates.

Follows a scaled subject through a trial and solves for joint torques.

Examples:
  mbkf reconstruct walk.trc --subject subject.toml --forces grf.mot --out result
  mbkf reconstruct walk.c3d --subject subject.toml --preset FDMC --set integrator=HE --out result
  mbkf reconstruct walk.c3d --subject subject.toml --imu imus.csv --imu-mounts imus.toml --out result
  mbkf reconstruct walk.c3d --subject subject.toml --causal --out as_live
  mbkf reconstruct walk.c3d --subject subject.toml --hide RKNE,RTIB@1.2:1.5 --without-plate 2 --out result

By default all later frames correct earlier ones (smoothing). With --causal a frame uses itself and earlier frames, as
in 'mbkf live'; with --lag MS also those of the next MS milliseconds. Every file but markers.trc states the choice.

The first line printed is the verdict: use, look or do not use, with the parts that it concerns and the reason. With
--strict the exit code is 3 where the word is "do not use".

Writes summary.json, motion.h5, angles.mot, angles_lab.mot, torques.sto, reactions.mot and markers.trc to the folder.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from mbkf.cli.options import (
    CAPTURE_FILES,
    FORCE_FILES,
    add_axes_options,
    add_convention,
    add_lag_option,
    add_out,
    add_preset_options,
    add_spreads_option,
    add_strict,
    add_without_plate,
    asked_spreads,
    axes_options,
    comma_separated,
    lag_seconds,
    strict_exit,
    with_chosen,
)
from mbkf.numerics.printed import percent

if TYPE_CHECKING:
    from mbkf.io.capture_pieces import CapturePieces
    from mbkf.io.records import Capture
    from mbkf.io.results_folder import Summary
    from mbkf.io.verdict import VerdictTold
    from mbkf.trial.inertial.on_body import ImuOnBody
    from mbkf.trial.preparation.settings import Hidden

MOST_REASONS = 4
"""Reasons that are printed below the first line."""


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("trial", metavar="TRIAL", help=f"capture ({CAPTURE_FILES})")
    parser.add_argument("--subject", required=True, metavar="SUBJECT.toml", help="written by 'mbkf scale'")
    parser.add_argument(
        "--forces", metavar="FILE", help=f"ground reactions ({FORCE_FILES}); a C3D brings its own plates"
    )
    _add_emg(parser)
    parser.add_argument(
        "--filter",
        choices=("kinematic", "torque", "dynamic"),
        help="the filter (default: that of the preset, or dynamic)",
    )
    add_preset_options(parser)
    later = parser.add_mutually_exclusive_group()
    later.add_argument(
        "--smooth", action="store_true", help="let later frames correct earlier ones (default)"
    )
    later.add_argument("--causal", action="store_true", help="use no later frames, as a live run")
    add_lag_option(later)
    parser.add_argument(
        "--hide",
        metavar="A,B@T0:T1",
        action="append",
        default=[],
        help="hide markers between two times in s; may be repeated",
    )
    parser.add_argument(
        "--imu",
        metavar="FILE",
        action="append",
        default=[],
        help="inertial sensors worn in the trial, named after their segments, on the same clock; may be repeated",
    )
    parser.add_argument(
        "--imu-mounts",
        metavar="FILE.toml",
        help="places of the sensors (default: found from the markers' motion)",
    )
    add_without_plate(parser)
    parser.add_argument(
        "--keep-markers",
        action="store_true",
        help="keep the subject's marker positions instead of correcting them on this trial",
    )
    parser.add_argument(
        "--feet-only",
        action="store_true",
        help="assume that only the feet bear load: estimate no seat, rail, knee, hand or carried load",
    )
    parser.add_argument(
        "--pelvis",
        choices=("progression", "lab"),
        default="progression",
        help="axes of the pelvis's angles: along the path of a walk or run, else the mean heading of pelvis and feet "
        "(progression, the default), or the laboratory's (lab)",
    )
    parser.add_argument(
        "--angles",
        choices=("model", "isb", "pig"),
        default="model",
        help="axes of joint angles: the body's own (model, the default), the ISB's (isb), or Plug-in Gait's (pig), for "
        "comparison with a laboratory's archive; moments stay about the body's own axes",
    )
    parser.add_argument(
        "--angles-zero",
        choices=("axes", "static"),
        default="axes",
        help="zero of joint angles: the axes of both segments coincide (axes, the default), or the posture of the "
        "static trial that scaled the subject (static)",
    )
    add_convention(parser, "model", "model; reports take it from the result")
    add_spreads_option(parser)
    add_axes_options(parser)
    add_strict(parser)
    add_out(parser, "DIR", "folder to write", required=True)


def _add_emg(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--emg",
        metavar="FILE",
        help="table of electromyograms (CSV, TSV, TXT, EMT, STO; default: TRIAL_emg.csv beside the trial)",
    )
    parser.add_argument(
        "--emg-offset",
        metavar="SECONDS",
        type=float,
        help="time to add to that of the EMG (default: as its line '# offset: 0.25' states, else 0)",
    )


def run(args: argparse.Namespace) -> int:
    """Reconstructs the trial, writes the folder and prints the key numbers."""
    from mbkf.cli.progress import stages
    from mbkf.io.atomic import check_folder
    from mbkf.io.records import Capture
    from mbkf.io.results_folder import RESULT_FILES, write_reconstruction
    from mbkf.io.subject import read_subject
    from mbkf.trial.preparation.settings import ReconstructSettings
    from mbkf.trial.reconstruct import reconstruct
    from mbkf.trial.results.truth import truth_beside

    hide = tuple(parse_hide(text) for text in args.hide)
    subject = read_subject(args.subject)
    without = tuple(args.without_plate)
    truth = truth_beside(args.trial)
    trial = _trial(args, whole=truth is not None)
    folder, imus = check_folder(args.out, RESULT_FILES), _imus(args)
    settings = ReconstructSettings(
        filter=args.filter or "dynamic",
        smooth=not args.causal and args.lag is None,  # a lag of 0 is causal
        lag_s=lag_seconds(args),
        correct_markers=not args.keep_markers,
        other_contacts=not args.feet_only,
        hide=hide,
        without_plates=without,
        pelvis=args.pelvis,
        angles=args.angles,
        angles_zero=args.angles_zero,
        convention=args.convention,
        spreads=asked_spreads(args),
        keep_covariance=truth is not None,
    )
    settings = with_chosen(settings, args)
    if isinstance(trial, Capture):
        with stages() as report:
            result = reconstruct(trial, subject, settings=settings, imus=imus, progress=report)
        from mbkf.trial.results.summary import summarise  # the first frame need not wait for it

        summary = summarise(result, truth)
        write_reconstruction(result, summary, folder)
    else:
        from mbkf.trial.long.reconstruct import reconstruct_long

        with stages() as report:
            summary = reconstruct_long(trial, subject, folder, settings=settings, progress=report)
        tables = (
            f"OpenSim's tables of this long trial are made by: mbkf export {folder} --to opensim --out DIR"
        )
        summary["warnings"] = [*summary["warnings"], tables]
    print_summary(summary, folder)
    return strict_exit(args, summary["verdict"])


def _trial(args: argparse.Namespace, whole: bool) -> Capture | CapturePieces:
    """The trial: read, or to be read in pieces where it is long and neither options nor ``whole`` need all of it."""
    from mbkf.io.capture import read_capture
    from mbkf.trial.long.choice import long_capture

    without, axes = tuple(args.without_plate), axes_options(args)
    if not whole and args.forces is None and args.emg is None and not args.imu:
        pieces = long_capture(args.trial, without, **axes)
        if pieces is not None:
            return pieces
    return read_capture(
        args.trial,
        forces=args.forces,
        unneeded_plates=without,
        emg=args.emg,
        emg_offset_s=args.emg_offset,
        **axes,
    )


def _imus(args: argparse.Namespace) -> ImuOnBody | None:
    """The sensors that ``--imu`` names."""
    if not args.imu:
        from mbkf.errors import InvalidInput

        if args.imu_mounts is not None:
            raise InvalidInput("--imu-mounts needs the readings; name them with --imu")
        return None
    from mbkf.io.imu.files import read_imu
    from mbkf.io.imu.mount import read_mounts
    from mbkf.trial.inertial.on_body import ImuOnBody

    readings = tuple(one for path in args.imu for one in read_imu(path))
    return ImuOnBody(readings, () if args.imu_mounts is None else read_mounts(args.imu_mounts))


def parse_hide(text: str) -> Hidden:
    """Reads ``A,B@T0:T1``.

    Raises:
        InvalidInput: The text is not of that form.
    """
    from mbkf.errors import InvalidInput
    from mbkf.trial.preparation.settings import Hidden

    names, at, window = text.partition("@")
    first, colon, last = window.partition(":")
    markers = comma_separated(names)
    try:
        times = float(first), float(last)
    except ValueError:
        times = math.nan, math.nan
    if not (at and colon and markers and math.isfinite(times[0]) and math.isfinite(times[1])):
        raise InvalidInput(f"--hide '{text}': write MARKER,MARKER@START:END with times in s")
    return Hidden(markers, *times)


def print_summary(summary: Summary, folder: Path) -> None:
    """Prints the key numbers of a result, its warnings and its folder."""
    from rich.table import Table

    from mbkf.cli.tables import terminal
    from mbkf.trial.preparation.coverage import listed

    along = summary["progression"]
    corrected = " after correction" if summary["filter"] == "torque" else ""
    unsmoothed = ", smoothing not counted" if summary["smoothed"] else ""
    realtime = summary["realtime_factor"]
    rows = [
        ("settings", settings_line(summary["settings"])),
        ("later frames", summary["later_frames"]),
        ("frames", f"{summary['frames']} at {summary['rate_hz']:g} Hz"),
        ("markers", f"{summary['markers_used']}, {percent(summary['missing_fraction'] or 0, 1)} missing"),
        ("markers ignored", listed(summary["markers_ignored"])),
        ("marker RMS / max", _pair(summary["marker_rms_mm"], summary["marker_max_mm"], "mm")),
        ("pelvis angles", f"{along['kind']}, {along['heading_deg']:z.0f}° from the x axis"),
        ("frames with all loads known", str(summary["valid_frames"])),
        ("frames with all loads measured", str(summary["measured_frames"])),
        (f"residual at the pelvis{corrected}", _residual(summary)),
        (
            "step median / 99 %",
            _pair(summary["step_seconds_median"], summary["step_seconds_p99"], "ms", 1e3),
        ),
        (f"times real time{unsmoothed}", "–" if realtime is None else f"{realtime:.1f}"),
    ]
    if summary["hidden_marker_rms_mm"] is not None:
        hidden = _pair(summary["hidden_marker_rms_mm"], summary["hidden_marker_max_mm"], "mm")
        rows.append(("hidden markers RMS / max", hidden))
    for name, value in (summary["truth"] or {}).items():
        rows.append(
            (f"against the truth: {name.replace('_', ' ')}", "–" if value is None else f"{value:.3f}")
        )
    rows.append(("unexplained loads", "\n".join(_unexplained(summary))))
    rows += [("checks", "\n".join(_checks(summary)))]
    title = f"{summary['trial']} ({summary['filter']} filter)"
    table = Table(title=title, title_justify="left", show_header=False)
    table.add_column()
    table.add_column(justify="right")
    for name, text in rows:
        if text:
            table.add_row(name, text)
    console = terminal()
    for line in verdict_lines(summary["trial"], summary["verdict"]):
        console.print(line, soft_wrap=True)
    console.print(table)
    for warning in summary["warnings"]:
        console.print(f"note: {warning}", soft_wrap=True)
    console.print(str(folder), soft_wrap=True)


def settings_line(settings: Mapping[str, object]) -> str:
    """The preset and the single settings that a result was made with; empty for the defaults.

    Args:
        settings: Settings of the run, as summaries have them.
    """
    preset, given = settings.get("preset"), settings.get("given")
    parts = [f"preset {preset}"] if preset else []
    parts += [f"{name} = {value}" for name, value in given.items()] if isinstance(given, Mapping) else []
    return ", ".join(parts)


def verdict_lines(trial: str, told: VerdictTold | None) -> list[str]:
    """The verdict on a trial and its gravest reason in a line, and the other reasons below.

    Args:
        trial: Name of the trial.
        told: The verdict as summaries have it; None gives no line.
    """
    from mbkf.io.verdict import Verdict

    if told is None:
        return []
    verdict = Verdict.of_table(told)
    others = verdict.sentences[1:]
    left = len(others) - MOST_REASONS
    more = [f"  and {left} more reason{'s' if left > 1 else ''} in summary.json"] if left > 0 else []
    return [f"{trial}: {verdict.line}", *(f"  {one}" for one in others[:MOST_REASONS]), *more]


def _unexplained(summary: Summary) -> list[str]:
    """Unexplained forces with their times."""
    return [
        f"{one['force_n']:.0f} N {one['direction']}, {one['from_s']:.2f} to {one['to_s']:.2f} s"
        for one in summary["unexplained"]
    ]


def _checks(summary: Summary) -> list[str]:
    """Counts of checks by their verdict, with the names of those that noise does not explain."""
    lines = []
    for verdict in ("inside", "doubtful", "outside", "not judged"):
        names = [str(check["name"]) for check in summary["checks"] if check["verdict"] == verdict]
        if names:
            listed = f": {', '.join(names)}" if verdict in ("doubtful", "outside") else ""
            lines.append(f"{len(names)} {verdict}{listed}")
    return lines


def _pair(first: float | None, second: float | None, unit: str, factor: float = 1.0) -> str:
    return " / ".join("–" if x is None else f"{factor * x:.1f}" for x in (first, second)) + f" {unit}"


def _residual(summary: Summary) -> str:
    """Force and moment, and both by body weight."""
    force, moment = summary["residual_force_rms_n"], summary["residual_moment_rms_nm"]
    if force is None:
        return ""
    found = _pair(force, moment, "N, N m")
    share, lever_m = summary["residual_force_share"], summary["residual_lever_m"]
    if share is None or lever_m is None:
        return found
    return f"{found} ({percent(share, 1)} of body weight, {1e3 * lever_m:.0f} mm)"
