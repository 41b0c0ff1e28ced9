"""Options that several commands share, and types of their values: a wrong one is refused with the option's name."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from pathlib import PurePath
from typing import TYPE_CHECKING, NamedTuple, TypedDict

from mbkf.io.capture import CAPTURES, FORCES
from mbkf.io.readers import either

if TYPE_CHECKING:
    from mbkf.io.verdict import VerdictTold
    from mbkf.trial.preparation.settings import ReconstructSettings

CAPTURE_FILES = either((*CAPTURES.suffixes_so_far, "that of an installed reader"))
"""Suffixes of captures that can be read, for help texts, which import no other package."""

FORCE_FILES = either((*FORCES.suffixes_so_far, "that of an installed reader"))
"""Suffixes of files of ground reactions that can be read."""


OUTPUTS = "outputs"
"""Name under which a command's parsed options list its :class:`Output`."""


class Output(NamedTuple):
    """An option that names a file or folder to write.

    Attributes:
        dest: Its name among the parsed options.
        folder: It names a folder.
        edits: Name of the option whose file it may replace, since the command edits that; empty for none.
        suffix: Of the one format that it is written in; empty where the name decides.
        either: It names a file or a folder, as the format has it.
    """

    dest: str
    folder: bool
    edits: str
    suffix: str
    either: bool = False


class AxesOptions(TypedDict):
    """Values of ``--up``, ``--axes`` and ``--unit``; None where not given."""

    up: str | None
    axes: str | None
    unit: str | None
    person: str | None


def axes_options(args: argparse.Namespace) -> AxesOptions:
    """The values of :func:`add_axes_options` as arguments of a reader."""
    return {"up": args.up, "axes": args.axes, "unit": args.unit, "person": args.person}


CONVENTIONS, COLOURS = ("clinical", "isb", "model"), ("blue-red", "green-red")
"""Values of ``--convention`` and ``--colours``, stated here because help texts import no other package."""


def add_convention(parser: argparse._ActionsContainer, default: str | None, otherwise: str) -> None:
    """Adds ``--convention``.

    Args:
        parser: Where.
        default: Its default; None: not asked for.
        otherwise: The default in words.
    """
    parser.add_argument(
        "--convention",
        choices=CONVENTIONS,
        default=default,
        help="axes, signs and order of curves: a gait laboratory's, with Plug-in Gait's axes and moments positive in "
        f"extension (clinical), the ISB's axes (isb), or the body's own (model); default: {otherwise}",
    )


def add_chart_options(parser: argparse._ActionsContainer, convention: str | None = None) -> None:
    """Adds ``--convention``, ``--moments`` and ``--colours`` of charts.

    Args:
        parser: Where.
        convention: The default; None: that of the result.
    """
    add_convention(parser, convention, convention or "that of the result")
    parser.add_argument(
        "--moments",
        choices=("internal", "external"),
        default="internal",
        help="name of the clinical convention's moments: of muscles and ligaments (internal), or of the load that they "
        "balance (external)",
    )
    parser.add_argument(
        "--colours", choices=COLOURS, default=COLOURS[0], help=f"colours of right and left ({COLOURS[0]})"
    )


def add_axes_options(parser: argparse.ArgumentParser) -> None:
    """Adds ``--up``, ``--axes``, ``--unit`` and ``--person``, for statements that files lack or have wrong."""
    parser.add_argument(
        "--up",
        metavar="AXIS",
        help="vertical axis of the files, pointing up: x, y, z; pointing down: --up=-x, --up=-y, --up=-z",
    )
    parser.add_argument(
        "--axes",
        metavar="X,Y,Z",
        help="axes of the files that point forward, left and up, e.g. x,-z,y (OpenSim); never corrected. A mirrored "
        "triple such as x,z,y mirrors the capture. Begin with --axes=-x,… if the first has a sign",
    )
    parser.add_argument("--unit", metavar="UNIT", help="length unit of the markers: mm, cm or m")
    parser.add_argument(
        "--person",
        metavar="NAME|N",
        help="of several persons in the file the one to take: name, or number as 'mbkf info' lists",
    )


def add_without_plate(parser: argparse.ArgumentParser) -> None:
    """Adds ``--without-plate``."""
    parser.add_argument(
        "--without-plate", metavar="N", action="append", default=[], help="withhold a plate; may be repeated"
    )


def add_out(
    parser: argparse._ActionsContainer,
    metavar: str,
    text: str,
    *,
    required: bool = False,
    default: str | None = None,
    option: str = "--out",
    edits: str = "",
) -> None:
    """Adds an option that names a file or folder to write, and once ``--overwrite``.

    ``mbkf`` looks at all of them before the command begins (:mod:`mbkf.cli.inputs`).

    Args:
        parser: The command's parser, or a group of it.
        metavar: "DIR" for a folder, "FILE|DIR" where the format decides; the name of a file otherwise, with the suffix
            of its format.
        text: Its help.
        required: It must be given.
        default: Value where it is not given.
        option: Its name.
        edits: As for :class:`Output`.
    """
    before: tuple[Output, ...] = parser.get_default(OUTPUTS) or ()
    suffix = "" if "|" in metavar else PurePath(metavar).suffix
    action = parser.add_argument(option, metavar=metavar, help=text, required=required, default=default)
    output = Output(action.dest, metavar == "DIR", edits, suffix, metavar.endswith("|DIR"))
    parser.set_defaults(**{OUTPUTS: (*before, output)})
    if not before:
        add_overwrite(parser)


def add_overwrite(parser: argparse._ActionsContainer) -> None:
    """Adds ``--overwrite``, for commands that write."""
    parser.add_argument(
        "--overwrite",
        action="store_true",
        help="replace existing files that mbkf did not write; files that the command reads always stay",
    )


def add_lag_option(parser: argparse._ActionsContainer) -> None:
    """Adds ``--lag``, for commands that follow a person frame by frame."""
    parser.add_argument(
        "--lag",
        type=not_negative,
        metavar="MS",
        help="estimate each frame MS milliseconds late, with the readings of that time (try 60)",
    )


def lag_seconds(args: argparse.Namespace) -> float:
    """The value of ``--lag`` in s; 0 where not given."""
    return (args.lag or 0.0) / 1e3


def add_spreads_option(parser: argparse._ActionsContainer) -> None:
    """Adds ``--spreads``, for commands that state standard deviations."""
    parser.add_argument(
        "--spreads",
        default="all",
        metavar="LIST",
        help="standard deviations besides those of configuration, velocity and reactions: torques, angles, both with "
        "a comma (all, the default), or none, which saves time in every frame",
    )


def add_preset_options(parser: argparse._ActionsContainer) -> None:
    """Adds ``--preset`` and ``--set``, for commands that run a filter."""
    parser.add_argument(
        "--preset",
        metavar="NAME|FILE",
        help="settings of a filter: one of 'mbkf presets', or a file that 'mbkf tune' or you wrote",
    )
    parser.add_argument(
        "--set",
        dest="given",
        metavar="NAME=VALUE",
        action="append",
        default=[],
        help="a single setting of the filter, such as integrator=HE or plate_force_n=10; may be repeated "
        "('mbkf presets --settings' lists all)",
    )


def with_chosen(settings: ReconstructSettings, args: argparse.Namespace) -> ReconstructSettings:
    """The settings with the values of :func:`add_preset_options`.

    Args:
        settings: All else.
        args: Options of the command, ``--filter`` among them.

    Raises:
        UnknownName: The preset or a setting does not exist.
        FileFormatError: The preset's file cannot be read.
        InvalidInput: A value is not possible.
    """
    from mbkf.trial.preparation.presets import with_preset, with_set

    if args.preset is not None:
        settings = with_preset(settings, args.preset, args.filter)
    return with_set(settings, args.given)


def add_static_only(parser: argparse._ActionsContainer) -> None:
    """Adds ``--static-only``, for commands that scale persons from sessions."""
    parser.add_argument(
        "--static-only",
        action="store_true",
        help="scale from the standing trial alone, not from those of the session's other trials that help",
    )


def asked_spreads(args: argparse.Namespace) -> tuple[str, ...]:
    """The value of ``--spreads`` as :attr:`ReconstructSettings.spreads` takes it."""
    from mbkf.filters.spread import ASKED

    asked = {"all": ASKED, "none": ()}
    return asked.get(args.spreads, tuple(args.spreads.split(",")))


def add_page_options(parser: argparse.ArgumentParser) -> None:
    """Adds ``--port`` and ``--no-browser``, for commands that serve a page."""
    parser.add_argument("--port", type=port, default=0, metavar="N", help="port of the page (any free one)")
    parser.add_argument("--no-browser", action="store_true", help="print the page's address only")


def comma_separated(text: str) -> tuple[str, ...]:
    """The words between commas, without blanks around them."""
    return tuple(word.strip() for word in text.split(",") if word.strip())


def time_window(option: str, text: str) -> tuple[float, float]:
    """Start and end, s, of ``START:END``.

    Raises:
        InvalidInput: The text has another form, or the end is not after the start.
    """
    from mbkf.errors import InvalidInput

    first, _, last = text.partition(":")
    try:
        window = float(first), float(last)
    except ValueError:
        window = math.nan, math.nan
    if not window[0] < window[1]:
        raise InvalidInput(f"{option} '{text}': write START:END in s, with START before END")
    return window


def _number(text: str, valid: Callable[[float], bool], rule: str) -> float:
    """A finite number that keeps a rule.

    Raises:
        ArgumentTypeError: It does not.
    """
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and valid(value)):
        raise argparse.ArgumentTypeError(f"'{text}' is not {rule}")
    return value


def positive(text: str) -> float:
    """A number above zero."""
    return _number(text, lambda x: x > 0.0, "a positive number")


def body_mass(text: str) -> float:
    """A body mass in kg."""
    return _number(text, lambda x: x > 0.0, "a positive body mass in kg")


def not_negative(text: str) -> float:
    """A number above zero, or zero."""
    return _number(text, lambda x: x >= 0.0, "a number of zero or more")


def share(text: str) -> float:
    """A number from 0 to 1."""
    return _number(text, lambda x: 0.0 <= x <= 1.0, "a number from 0 to 1")


def natural(text: str) -> int:
    """A whole number of zero or more."""
    return int(_number(text, lambda x: x >= 0.0 and x == int(x), "a whole number of zero or more"))


def count(text: str) -> int:
    """A whole number of one or more."""
    return int(_number(text, lambda x: x >= 1.0 and x == int(x), "a whole number of one or more"))


def port(text: str) -> int:
    """A port from 0, any free one, to 65535."""
    rule = "a port from 0 (any free one) to 65535"
    return int(_number(text, lambda x: 0.0 <= x <= 65535.0 and x == int(x), rule))


EXIT_DO_NOT_USE = 3
"""Exit code with ``--strict`` where the verdict is "do not use"."""


def add_strict(parser: argparse._ActionsContainer) -> None:
    """Adds ``--strict``."""
    parser.add_argument(
        "--strict", action="store_true", help='exit with 3 where the verdict is "do not use", after writing'
    )


def strict_exit(args: argparse.Namespace, told: VerdictTold | None) -> int:
    """0, or with ``--strict`` 3 where the verdict is "do not use".

    Args:
        args: Options of the command.
        told: The verdict as summaries have it.
    """
    return EXIT_DO_NOT_USE if args.strict and told is not None and told["overall"] == "do not use" else 0
