"""Gains beta and zeta of Madgwick's filter.

A still sensor shows the gyroscope's noise and drift: beta = sqrt(3/4) noise, zeta = sqrt(3/4) drift. Those gains only
suit a sensor that hardly moves. --search finds the gains that follow a reference best: the orientation in the file, or
the offline Kalman filter (--against smooth).

Examples:
  mbkf imu tune resting.csv
  mbkf imu tune trial.mat --static 0:30
  mbkf imu tune trial.mat --search --against file --frame ENU --out gains.json
"""

from __future__ import annotations

import argparse
import json
import math
from typing import Any

from mbkf.cli.imu import add_reading_options, read
from mbkf.cli.options import add_out, time_window


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("file", metavar="FILE", help="inertial readings")
    add_reading_options(parser)
    parser.add_argument("--static", metavar="T0:T1", help="the still stretch in s (default: the longest one)")
    parser.add_argument("--search", action="store_true", help="search the gains that follow a reference best")
    parser.add_argument("--against", choices=("file", "smooth"), default="file", help="the reference (file)")
    parser.add_argument(
        "--frame", default="ENU", choices=("ENU", "NED", "NWU"), help="world of the comparison (ENU)"
    )
    parser.add_argument("--no-mag", action="store_true", help="ignore the magnetometer")
    add_out(parser, "FILE.json", "file for the numbers")


def run(args: argparse.Namespace) -> int:
    """Finds the gains, prints and writes them."""
    from mbkf.io.atomic import write_text
    from mbkf.trial.inertial.orient import prepared

    sensors, warnings = prepared(read([args.file], args), args.sensor)
    rows = []
    for one in sensors:
        row, text = _searched(one, args) if args.search else _static(one, args.static)
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


def _searched(one: Any, args: argparse.Namespace) -> tuple[dict[str, Any], str]:
    from mbkf.cli.progress import stages
    from mbkf.imu.orientation import OrientSettings, orientations
    from mbkf.imu.tuning import reference_of, searched_gains

    magnetometer = not args.no_mag and one.magnetic_field is not None
    with stages() as report:
        if args.against == "file":
            reference = reference_of(one, args.frame)
        else:
            smooth = OrientSettings("smooth", magnetometer)
            reference = orientations([one], frame=args.frame, settings=smooth, progress=report)[0].quaternion
        found = searched_gains(
            one,
            reference,
            frame=args.frame,
            magnetometer=magnetometer,
            progress=lambda done, total: report("Search", done, total),
        )
    beta, zeta, error = found.settings.beta, found.settings.zeta, math.degrees(found.error.total)
    text = (
        f"beta {beta:.4g}, zeta {zeta:.3g} differ least from the reference: {error:.2f} deg "
        f"(inclination {math.degrees(found.error.inclination):.2f}), best of {len(found.trials)} gains"
    )
    row = {
        "name": one.name,
        "procedure": "search",
        "against": args.against,
        "beta": beta,
        "zeta": zeta,
        "error_deg": error,
        "trials": [{"beta": b, "zeta": z, "error_deg": math.degrees(e)} for b, z, e in found.trials],
    }
    return row, text
