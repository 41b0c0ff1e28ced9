"""Make a synthetic capture with exact truth.

A random person performs a motion that obeys Newton's law exactly, recorded by imperfect cameras and force plates.
Writes trial.c3d (labelled), raw.c3d (unlabelled, with ghosts), static.c3d, subject.toml and truth.h5.

Example:
  mbkf synth --motion walk --seconds 4 --seed 7 --out walk7
"""

from __future__ import annotations

import argparse

from mbkf.cli.options import add_out, natural
from mbkf.synthesis.motions import motion_names, registered_motion


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    add_motion_options(parser)
    parser.add_argument("--rate", metavar="HZ", type=float, default=100.0, help="camera rate (100)")
    parser.add_argument(
        "--markers-mm", metavar="SD", type=float, default=0.5, help="camera noise in mm (0.5)"
    )
    parser.add_argument(
        "--skin-mm", metavar="SD", type=float, default=3.0, help="movement of the skin in mm (3)"
    )
    parser.add_argument("--ghosts", metavar="N", type=int, default=2, help="ghost reflections in raw.c3d (2)")
    parser.add_argument(
        "--occlusion",
        metavar="FRACTION",
        type=float,
        default=0.02,
        help="fraction of marker samples hidden (0.02)",
    )
    parser.add_argument(
        "--varied",
        action="store_true",
        help="joint centres, posture and skin that differ as people's do, to judge stated intervals",
    )
    add_out(parser, "DIR", "folder to write", required=True)


def add_motion_options(parser: argparse.ArgumentParser) -> None:
    """Adds the options that choose the motion, shared with ``mbkf demo``."""
    motions = [registered_motion(name) for name in motion_names(installed=False)]
    first = motions[0].name
    usual = ", ".join(f"{one.name} {one.seconds:g}" for one in motions)
    parser.add_argument(
        "--motion",
        metavar="NAME",
        default=first,
        help=f"see --seconds, or that of an installed package ({first})",
    )
    parser.add_argument("--seconds", metavar="S", type=float, help=f"duration; by default {usual}")
    parser.add_argument(
        "--seed",
        metavar="N",
        type=natural,
        default=0,
        help="number of the random person, motion and noise (0)",
    )


def run(args: argparse.Namespace) -> int:
    """Makes the capture and writes its folder."""
    from mbkf.cli.progress import stages
    from mbkf.io.atomic import check_folder
    from mbkf.synthesis.capture import CaptureSettings
    from mbkf.trial.synth import FILES, synthesise, write_folder

    check_folder(args.out, FILES)
    settings = CaptureSettings(
        markers_sd_m=args.markers_mm / 1e3,
        skin_sd_m=args.skin_mm / 1e3,
        ghosts=args.ghosts,
        occlusion=args.occlusion,
    )
    with stages() as report:
        subject, capture = synthesise(
            args.motion,
            seconds=args.seconds,
            seed=args.seed,
            rate_hz=args.rate,
            settings=settings,
            varied=args.varied,
            progress=report,
        )
    paths = write_folder(subject, capture, args.out)
    print(
        f"{args.motion}: {capture.trial.markers.frames} frames at {args.rate:g} Hz, {subject.mass_kg:.1f} kg, "
        f"{len(capture.trial.plates)} plates, seed {args.seed}"
    )
    for path in paths:
        print(f"  {path}")
    return 0
