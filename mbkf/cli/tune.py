"""Find a filter's noise settings on trials.

Finds the noise settings under which the filter's innovations over trials of one subject are most probable, and saves
them as a preset. The last trial (of a single one its second half) is held out: its likelihood before and after shows
whether the settings hold elsewhere; if not, the preset keeps the defaults. Named presets lie in ~/.config/mbkf/presets,
or in the folder MBKF_PRESETS.

Examples:
  mbkf tune walk1.c3d walk2.c3d walk3.c3d --subject subject.toml --name lab
  mbkf tune walk.trc --subject subject.toml --forces grf.mot --name walk --out walk.toml
  mbkf reconstruct walk4.c3d --subject subject.toml --preset lab --out result

With --preset or --set the search begins there, and the preset that is saved holds these settings, too.

The likelihood assumes that readings err independently from frame to frame. Skin does not, so the most probable settings
need not be the best for torques. On synthetic trials with 5 mm of moving skin tuning about halved the torque error of
the kinematic filter; that of the dynamic filter fell by 10 to 30 % on squats and mostly rose on walks and jumps, by 10
to 40 %. Compare residuals and torques before you trust a preset.

Parameters (those with * by default):
  dynamic:    motion*   how much the body accelerates
              loads*    how fast foot loads change
              plates*   noise of the plates
              law       how exactly Newton's law holds at the pelvis
              share     how large innovations are beside the markers' noise that follows them (innovation_share)
              markers   noise of the markers
  kinematic:  motion*, markers*
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from mbkf.cli.force_files import forces_of
from mbkf.cli.options import (
    CAPTURE_FILES,
    add_axes_options,
    add_out,
    add_preset_options,
    axes_options,
    comma_separated,
    count,
    with_chosen,
)

if TYPE_CHECKING:
    from mbkf.io.preset import Preset
    from mbkf.study.tune import Tuned


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("trials", metavar="TRIAL", nargs="+", help=f"captures ({CAPTURE_FILES})")
    parser.add_argument("--subject", required=True, metavar="SUBJECT.toml", help="written by 'mbkf scale'")
    parser.add_argument(
        "--forces",
        metavar="FILE",
        nargs="+",
        default=[],
        help="ground reactions of the trials other than C3D, in their order",
    )
    parser.add_argument(
        "--filter",
        choices=("dynamic", "kinematic"),
        help="the filter (default: that of the preset, or dynamic)",
    )
    add_preset_options(parser)
    parser.add_argument("--name", required=True, metavar="NAME", help="name of the preset")
    add_out(parser, "PRESET.toml", "file to write, instead of one among the named presets")
    parser.add_argument(
        "--hold-out", metavar="TRIAL", action="append", default=[], help="trial that only judges; repeatable"
    )
    parser.add_argument("--parameters", metavar="A,B", help="parameters to tune, see below")
    parser.add_argument("--runs", metavar="N", type=count, default=60, help="most runs of the search (60)")
    parser.add_argument(
        "--keep-markers",
        action="store_true",
        help="keep the subject's marker positions instead of correcting them on each trial",
    )
    add_axes_options(parser)


def run(args: argparse.Namespace) -> int:
    """Tunes, writes the preset and prints the settings."""
    from mbkf.cli.progress import stages
    from mbkf.io.atomic import check_file
    from mbkf.io.capture import read_capture
    from mbkf.io.preset import write_preset
    from mbkf.io.subject import read_subject
    from mbkf.study.tune import TuneSettings, tune
    from mbkf.trial.preparation.presets import check_name, place_of
    from mbkf.trial.preparation.settings import ReconstructSettings

    out = place_of(check_name(args.name), args.out)
    check_file(out)
    held_out, forces = positions(args.trials, args.hold_out), forces_of(args.trials, args.forces)
    start = with_chosen(
        ReconstructSettings(filter=args.filter or "dynamic", correct_markers=not args.keep_markers), args
    )
    settings = TuneSettings(
        filter=start.filter,
        parameters=None if args.parameters is None else comma_separated(args.parameters),
        hold_out=held_out,
        calls=args.runs,
        reconstruct=start,
    )
    subject = read_subject(args.subject)
    captures = [
        read_capture(trial, forces=file, **axes_options(args))
        for trial, file in zip(args.trials, forces, strict=True)
    ]
    with stages() as report:
        tuned = tune(captures, subject, settings=settings, progress=report)
    preset = tuned.preset(args.name)
    write_preset(preset, out)
    _print(tuned, preset, out)
    return 0


def positions(trials: Sequence[str], held_out: Sequence[str]) -> tuple[int, ...] | None:
    """Numbers of the trials to hold out, each named as it was given or by its file's name without folder and suffix.

    Raises:
        UnknownName: It is not among the trials.
    """
    from mbkf.errors import UnknownName

    found: set[int] = set()
    for name in held_out:
        mine = {i for i, trial in enumerate(trials) if name in (trial, Path(trial).name, Path(trial).stem)}
        if not mine:
            raise UnknownName("trial", name, trials, "--hold-out")
        found |= mine
    return tuple(sorted(found)) or None


def _print(tuned: Tuned, preset: Preset, out: Path) -> None:
    from mbkf.cli.tables import table, terminal

    console = terminal()
    shown = table(f"Settings of the {tuned.filter} filter", "setting", "default", "found", "in the preset")
    for key, found in tuned.values.items():
        numbers = (tuned.defaults[key], found, preset.values[key])
        shown.add_row(key.replace("_", " "), *(f"{x:g}" for x in numbers))
    console.print(shown)
    for title, part, names in (
        ("tuned on", "tuned", tuned.tuned_on),
        ("held out", "held_out", tuned.held_out),
    ):
        before, after = tuned.likelihood[f"{part}_before"], tuned.likelihood[f"{part}_after"]
        console.print(
            f"{title}: {', '.join(names)}: {before:.4f} → {after:.4f} nats per reading", soft_wrap=True
        )
    console.print(f"{tuned.calls} runs over the trials in {tuned.seconds:.0f} s")
    for warning in tuned.warnings:
        console.print(f"note: {warning}", soft_wrap=True)
    console.print(str(out), soft_wrap=True)
