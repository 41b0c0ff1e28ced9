"""Options that several commands share, and checks of what they were given."""

from __future__ import annotations

import argparse
import math
from typing import TypedDict

from mbkf.io.capture import CAPTURES, FORCES
from mbkf.io.readers import either

CAPTURE_FILES = either((*CAPTURES.suffixes_so_far, "that of an installed reader"))
"""Suffixes of the captures that can be read, for help texts, which import no other package."""

FORCE_FILES = either((*FORCES.suffixes_so_far, "that of an installed reader"))
"""Suffixes of the files of ground reactions that can be read."""


class AxesOptions(TypedDict):
    """How files are read: the values of ``--up``, ``--axes`` and ``--unit``, None where not given."""

    up: str | None
    axes: str | None
    unit: str | None


def axes_options(args: argparse.Namespace) -> AxesOptions:
    """What :func:`add_axes_options` was given, as arguments of a reader."""
    return {"up": args.up, "axes": args.axes, "unit": args.unit}


def add_axes_options(parser: argparse.ArgumentParser) -> None:
    """``--up``, ``--axes`` and ``--unit``, for files that do not say, or say it wrongly."""
    parser.add_argument(
        "--up",
        metavar="AXIS",
        help="axis of the files that points up: x, y, z, or downwards --up=-x, --up=-y, --up=-z",
    )
    parser.add_argument(
        "--axes",
        metavar="X,Y,Z",
        help="axes of the files that point forward, left and up, for example x,-z,y (OpenSim); x,z,y mirrors such a "
        "file; they hold whatever the body looks like (--axes=-x,... where the first has a sign)",
    )
    parser.add_argument("--unit", metavar="UNIT", help="length unit of the markers: mm, cm or m")


def add_lag_option(parser: argparse._ActionsContainer) -> None:
    """``--lag``, for commands that follow a person frame by frame."""
    parser.add_argument(
        "--lag",
        type=float,
        metavar="MS",
        help="give each frame so many ms later, with what the readings until then tell of it (try 60)",
    )


def add_spreads_option(parser: argparse._ActionsContainer) -> None:
    """``--spreads``, for commands that tell standard deviations."""
    parser.add_argument(
        "--spreads",
        default="all",
        metavar="LIST",
        help="standard deviations to tell besides those of configuration, velocity and reactions: torques, angles, "
        "both with a comma (all, the default), or none; a frame costs less without",
    )


def asked_spreads(args: argparse.Namespace) -> tuple[str, ...]:
    """What :func:`add_spreads_option` was given, by :attr:`ReconstructSettings.spreads`' names."""
    from mbkf.filters.spread import ASKED

    asked = {"all": ASKED, "none": ()}
    return asked.get(args.spreads, tuple(args.spreads.split(",")))


def lag_seconds(args: argparse.Namespace) -> float:
    """What :func:`add_lag_option` was given, in s; 0 if nothing.

    Raises:
        InvalidInput: It is not a time.
    """
    lag_ms = 0.0 if args.lag is None else float(args.lag)
    check_positive("--lag", lag_ms, or_zero=True)
    return lag_ms / 1e3


def check_positive(option: str, value: float, or_zero: bool = False) -> None:
    """Refuses a value that is not a positive number.

    Args:
        option: Name of the option.
        value: Its value.
        or_zero: Whether zero is accepted, too.

    Raises:
        InvalidInput: The value is not positive, or not finite.
    """
    from mbkf.errors import InvalidInput

    if not math.isfinite(value) or value < 0.0 or (value == 0.0 and not or_zero):
        raise InvalidInput(f"{option} {value:g}: give a positive number")


def check_share(option: str, value: float) -> None:
    """Refuses what is not a share.

    Raises:
        InvalidInput: It is not between 0 and 1.
    """
    from mbkf.errors import InvalidInput

    if not 0.0 <= value <= 1.0:
        raise InvalidInput(f"{option} {value:g}: give a share between 0 and 1")
