"""Gains beta and zeta of Madgwick's filter.

A still sensor shows the gyroscope's noise and drift: beta = sqrt(3/4) noise, zeta = sqrt(3/4) drift. Those gains only
suit a sensor that hardly moves. --search finds the gains that follow a reference best: the orientation in the file,
that in another file (a maker's export of quaternions), or the offline Kalman filter (--against smooth). With --betas or
--zetas all pairs of these are tried; --figure draws the search.

Examples:
  mbkf imu tune resting.csv
  mbkf imu tune trial.mat --static 0:30
  mbkf imu tune trial.mat --search --against file --frame ENU --out gains.json
  mbkf imu tune walk.csv --search --against quaternions.csv --initial compared --betas 0.1:1:10 --zetas 0.01:0.1:10 \
      --figure sweep.png
"""

from __future__ import annotations

import argparse
import json
import math
from typing import TYPE_CHECKING, Any

from mbkf.cli.imu import add_reading_options, read
from mbkf.cli.options import add_out, time_window

if TYPE_CHECKING:
    from mbkf.conventions import Array, StageCallback
    from mbkf.imu.orientation import Orientation
    from mbkf.imu.tuning import GainComparison, SearchedGains
    from mbkf.io.imu.readings import ImuReadings


MOST_VALUES = 200
"""Number of betas or zetas of a sweep at most."""

SWEPT_BETAS = tuple(round(0.1 * k, 1) for k in range(1, 11))
"""Betas of a sweep that names zetas only: those of the source's first one."""


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("file", metavar="FILE", help="inertial readings")
    add_reading_options(parser)
    parser.add_argument("--static", metavar="T0:T1", help="the still stretch in s (default: the longest one)")
    parser.add_argument("--search", action="store_true", help="search the gains that follow a reference best")
    parser.add_argument(
        "--against", metavar="file|smooth|FILE", default="file", help="the reference (default: file, its own)"
    )
    for name in ("betas", "zetas"):
        parser.add_argument(
            f"--{name}", metavar="FIRST:LAST:COUNT", type=values, help=f"{name} of --search, evenly spaced"
        )
    parser.add_argument(
        "--initial",
        choices=("compared",),
        help="begin each run of --search with the reference's first orientation",
    )
    add_out(
        parser, "FILE.png", "picture of --search (needs matplotlib, the extra 'figures')", option="--figure"
    )
    parser.add_argument(
        "--frame", default="ENU", choices=("ENU", "NED", "NWU"), help="world of the comparison (ENU)"
    )
    parser.add_argument("--no-mag", action="store_true", help="ignore the magnetometer")
    add_out(parser, "FILE.json", "file for the numbers")


def run(args: argparse.Namespace) -> int:
    """Finds the gains, prints and writes them.

    Raises:
        InvalidInput: An option belongs to --search, which is not given, or several sensors are to be drawn.
    """
    from mbkf.errors import InvalidInput
    from mbkf.io.atomic import write_text
    from mbkf.trial.inertial.orient import prepared

    _check(args)
    sensors, warnings = prepared(read([args.file], args), args.sensor)
    if args.figure is not None and len(sensors) > 1:
        raise InvalidInput(
            f"--figure draws one sensor, and {args.file} has {len(sensors)}; choose one with --sensor"
        )
    rows = []
    for one in sensors:
        row, text, notes = _searched(one, args) if args.search else (*_static(one, args.static), ())
        warnings = (*warnings, *notes)
        rows.append(row)
        print(f"{one.name}: {text}")
    for warning in warnings:
        print(f"note: {warning}")
    if args.out is not None:
        found = {"sensors": rows, "warnings": list(warnings)}
        write_text(args.out, json.dumps(found, indent=2) + "\n")
    return 0


def _static(one: Any, window: str | None) -> tuple[dict[str, Any], str]:
    from mbkf.imu.tuning import static_gains, still_stretch

    first, last = still_stretch(one) if window is None else _stretch(one, window)
    found = static_gains(one, first, last)
    text = (
        f"still from {found.from_s:.2f} to {found.to_s:.2f} s; gyroscope noise {found.gyro_noise_rad_s:.2e} rad/s, "
        f"drift {found.gyro_drift_rad_s2:.1e} rad/s2: beta {found.beta:.4g}, zeta {found.zeta:.3g} (for a sensor "
        "that hardly moves; --search finds those of a moving one)"
    )
    row = {
        "name": one.name,
        "procedure": "static",
        "beta": found.beta,
        "zeta": found.zeta,
        "gyro_noise_rad_s": found.gyro_noise_rad_s,
        "gyro_drift_rad_s2": found.gyro_drift_rad_s2,
        "gyro_bias_rad_s": found.gyro_bias_rad_s.tolist(),
        "from_s": found.from_s,
        "to_s": found.to_s,
    }
    return row, text


def _stretch(one: Any, window: str) -> tuple[int, int]:
    """First sample of a window, and the one after its last.

    Raises:
        InvalidInput: No sample lies in it.
    """
    import numpy as np

    from mbkf.errors import InvalidInput

    start, end = time_window("--static", window)
    inside = np.flatnonzero((one.time_s >= start) & (one.time_s <= end))
    if not len(inside):
        raise InvalidInput(
            f"--static '{window}': the recording lasts from {one.time_s[0]:.2f} to {one.time_s[-1]:.2f} s"
        )
    return int(inside[0]), int(inside[-1]) + 1


def values(text: str) -> list[float]:
    """Reads ``FIRST:LAST:COUNT`` as so many evenly spaced gains.

    Raises:
        ArgumentTypeError: The text is not of that form, or a gain is negative.
    """
    try:
        first, last, count = text.split(":")
        low, high, number = float(first), float(last), int(count)
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}': write FIRST:LAST:COUNT, as in 0.1:1:10") from None
    if not (0.0 <= low <= high < math.inf and 1 <= number <= MOST_VALUES):
        raise argparse.ArgumentTypeError(
            f"'{text}': gains are 0 or more, the last not below the first, and 1 to {MOST_VALUES} of them"
        )
    return [low + (high - low) * k / max(number - 1, 1) for k in range(number)]


def _check(args: argparse.Namespace) -> None:
    """Refuses options of --search without it, before any work."""
    from mbkf.errors import InvalidInput

    given = {name: getattr(args, name) for name in ("betas", "zetas", "figure", "initial")}
    for name, value in given.items():
        if value is not None and not args.search:
            raise InvalidInput(f"--{name} belongs to --search; give --search, too")


def _reference(
    one: ImuReadings, args: argparse.Namespace, report: StageCallback
) -> tuple[Array, tuple[str, ...]]:
    """(T, 4) the orientation that gains are to follow, and notes."""
    from mbkf.imu.orientation import OrientSettings, orientations
    from mbkf.imu.tuning import reference_of
    from mbkf.trial.inertial.stated_orientation import OWN, stated_orientations

    if args.against == OWN:
        return reference_of(one, args.frame), ()
    if args.against == "smooth":
        smooth = OrientSettings("smooth", _magnetic(one, args))
        (course,) = orientations([one], frame=args.frame, settings=smooth, progress=report)
        return course.quaternion, ()
    (stated,), notes = stated_orientations([one], args.frame, args.against)
    return stated.quaternion, notes


def _magnetic(one: ImuReadings, args: argparse.Namespace) -> bool:
    return not args.no_mag and one.magnetic_field is not None


def _searched(one: ImuReadings, args: argparse.Namespace) -> tuple[dict[str, Any], str, tuple[str, ...]]:
    """Numbers, a sentence and notes of a search.

    Raises:
        InvalidInput: The reference does not state the first orientation.
    """
    import numpy as np

    from mbkf.cli.progress import stages
    from mbkf.errors import InvalidInput
    from mbkf.imu.tuning import GainComparison, searched_gains, swept_gains

    if args.figure is not None:
        from mbkf.viz.imu.gain_sweep import write_sweep
    with stages() as report:
        reference, notes = _reference(one, args, report)
        start = None if args.initial is None else reference[0]
        if start is not None and not np.isfinite(start).all():
            raise InvalidInput(
                f"sensor {one.name}: its reference states no first orientation; leave --initial out"
            )
        comparison = GainComparison(
            one, reference, args.frame, magnetometer=_magnetic(one, args), start=start
        )

        def progress(done: int, total: int) -> None:
            report("Search", done, total)

        if args.betas is None and args.zetas is None:
            found = searched_gains(comparison, progress)
        else:
            found = swept_gains(comparison, args.betas or SWEPT_BETAS, args.zetas or (0.0,), progress)
        if args.figure is not None:
            write_sweep(found, reference, _shown(comparison, found), args.figure)
    return (*_reported(one, found, args.against), notes)


def _shown(comparison: GainComparison, found: SearchedGains) -> list[tuple[str, Orientation]]:
    """Courses of the best gains, and of the least and greatest β beside them."""
    from mbkf.imu.madgwick import MadgwickSettings

    best = found.settings
    betas = sorted({beta for beta, _, _ in found.trials})
    chosen = [
        best,
        *(MadgwickSettings(beta, best.zeta) for beta in (betas[0], betas[-1]) if beta != best.beta),
    ]
    return [(f"β {gains.beta:.3g}, ζ {gains.zeta:.3g}", comparison.course(gains)) for gains in chosen]


def _reported(one: ImuReadings, found: SearchedGains, against: str) -> tuple[dict[str, Any], str]:
    beta, zeta, error = found.settings.beta, found.settings.zeta, math.degrees(found.error.total)
    text = (
        f"beta {beta:.4g}, zeta {zeta:.3g} differ least from the reference: {error:.2f} deg "
        f"(inclination {math.degrees(found.error.inclination):.2f}), best of {len(found.trials)} gains"
    )
    row = {
        "name": one.name,
        "procedure": "search",
        "against": against,
        "beta": beta,
        "zeta": zeta,
        "error_deg": error,
        "trials": [{"beta": b, "zeta": z, "error_deg": math.degrees(e)} for b, z, e in found.trials],
    }
    return row, text
