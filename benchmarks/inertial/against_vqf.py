"""Orientation on all BROAD trials at hand, beside VQF in the same run: whole trials, starts in motion, stated spreads.

Judged over the movement phases that the files mark, without alignment (Laidig et al., Data 2021, 6(7):72). VQF is D.
Laidig and T. Seel, Information Fusion 91 (2023) 187–204.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from time import process_time

import numpy as np

from benchmarks.checks import Check, Context
from benchmarks.kernel import using
from mbkf.conventions import Array
from mbkf.imu.frames import change_frame, conjugate, multiply
from mbkf.imu.orientation import Orientation, OrientSettings, orientations
from mbkf.imu.orientation_error import OrientationError, orientation_error
from mbkf.io.imu.files import read_imu
from mbkf.io.imu.readings import ImuReadings
from mbkf.kernel.loading import COMPILED, REFERENCE, library

CHOSEN = ("05", "11", "21", "33")
"""Trials on which settings were chosen; the others show them."""

FASTER = 10.0
"""Smoothing by the compiled kernel against numpy, both by processor time in one run."""

CUT_S, CUTS, BIAS_RAD_S, TURNING_RAD_S = 60.0, 10, float(np.radians(0.5)), 1.0
"""Length and number of pieces that start in motion, the bias that is added, and what counts as motion."""


def trials(context: Context) -> list[ImuReadings]:
    """The trials of BROAD in the data folder, in order."""
    files = sorted((context.require_data() / "imu_broad").glob("*.mat"))
    return [one for path in files for one in read_imu(path)]


def rows(context: Context) -> Iterator[Check]:
    """Errors against VQF's, spreads, and starts in motion."""
    sensors = trials(context)[: 2 if context.quick else None]
    for method, kind, bounds in (("ekf", "online", (0.95, 0.95)), ("smooth", "offline", (0.85, 1.0))):
        own, theirs = followed(sensors, method), [_vqf(one, method) for one in sensors]
        found = [_error(q.quaternion, one) for q, one in zip(own, sensors, strict=True)]
        other = [_error(q, one) for q, one in zip(theirs, sensors, strict=True)]
        for part, bound in zip(("total", "inclination"), bounds, strict=True):
            mine, vqf = (np.array([getattr(one, part) for one in errors]) for errors in (found, other))
            yield _degrees(f"BROAD, {kind}: {part}, mean of {len(sensors)} trials", mine.mean())
            yield _degrees(f"BROAD, VQF {kind}: {part}", vqf.mean())
            yield Check(f"BROAD, {kind}: {part} / VQF's", float(mine.mean() / vqf.mean()), bound, "<=")
            for label, wanted in (("chosen on", True), ("shown on", False)):
                kept = [k for k, one in enumerate(sensors) if (one.name[:2] in CHOSEN) is wanted]
                if kept:
                    share = float(mine[kept].mean() / vqf[kept].mean())
                    yield Check(f"BROAD, {kind}: {part} / VQF's, trials {label}", share, np.inf, "<=")
        yield from _spreads(kind, own, sensors)
    yield from _starts(sensors)
    yield from _speed(sensors[0])


def _speed(one: ImuReadings) -> Iterator[Check]:
    """Smoothing by the compiled kernel beside smoothing in numpy, on one trial, by processor time."""
    if library() is None:
        yield Check("smoothing, compiled: times faster than numpy", np.nan, FASTER, ">=")
        return
    spent, found = dict[str, float](), dict[str, Array]()
    for kernel in (COMPILED, REFERENCE, COMPILED):  # the first one loads libraries
        with using(kernel):
            begun = process_time()
            found[kernel] = followed([one], "smooth")[0].quaternion
            spent[kernel] = process_time() - begun
    yield Check(
        "smoothing, compiled: times faster than numpy", spent[REFERENCE] / spent[COMPILED], FASTER, ">="
    )
    share = len(one.time_s) / one.rate_hz / spent[COMPILED]
    yield Check("smoothing, compiled: seconds of one sensor per second", share, -np.inf, ">=")
    apart = float(np.nanmax(np.abs(found[COMPILED] - found[REFERENCE])))
    yield Check("smoothing, compiled: largest difference of a quaternion from numpy's", apart, 1e-9, "<=")


def followed(sensors: Sequence[ImuReadings], method: str) -> list[Orientation]:
    """Courses of all sensors in ENU, made equally long so that they run side by side.

    Args:
        sensors: The sensors.
        method: A key of :data:`mbkf.imu.orientation.METHODS`.
    """
    longest = max(one.samples for one in sensors)
    found = orientations(
        [_longer(one, longest) for one in sensors], frame="ENU", settings=OrientSettings(method)
    )
    return [
        replace(course, **{name: getattr(course, name)[: one.samples] for name in _COURSES})
        for course, one in zip(found, sensors, strict=True)
    ]


_COURSES = ("time_s", "quaternion", "gyro_bias_rad_s", "sd_rad")


def _longer(one: ImuReadings, samples: int) -> ImuReadings:
    """The readings, followed by a sensor that lies still where they end."""

    def grown(values: Array | None, last: Array | None = None) -> Array | None:
        if values is None:
            return None
        end = values[-1:] if last is None else last[None]
        return np.concatenate([values, np.repeat(end, samples - len(values), axis=0)])

    force, rate = grown(one.specific_force_mps2), grown(one.angular_velocity_rad_s, np.zeros(3))
    assert force is not None and rate is not None
    times = np.arange(samples) / one.rate_hz
    return ImuReadings(one.name, times, force, rate, grown(one.magnetic_field), one.rate_hz)


def _vqf(one: ImuReadings, method: str) -> Array:
    """(T, 4) VQF's orientation."""
    from vqf import VQF, offlineVQF

    parts = [
        np.ascontiguousarray(x)
        for x in (one.angular_velocity_rad_s, one.specific_force_mps2, one.magnetic_field)
    ]
    dt = 1.0 / one.rate_hz
    found = VQF(dt).updateBatch(*parts) if method == "ekf" else offlineVQF(*parts, dt)
    return np.asarray(found["quat9D"][:, [1, 2, 3, 0]])


def _error(quaternion: Array, one: ImuReadings) -> OrientationError:
    assert one.orientation is not None
    return orientation_error(quaternion, one.orientation, one.moving)


def _degrees(name: str, angle_rad: float) -> Check:
    return Check(name, float(np.degrees(angle_rad)), np.inf, "<=", "deg")


def _spreads(kind: str, own: Sequence[Orientation], sensors: Sequence[ImuReadings]) -> Iterator[Check]:
    """Errors over stated spreads of tilt and heading, root mean square over all trials, and cover by 95 % intervals.

    A heading errs by what iron does to the field, once per trial: the root of each trial by itself is small in most of
    them and large in some, and its mean (for information) smaller than the spread of such errors.
    """
    scaled = [standardised(course, one) for course, one in zip(own, sensors, strict=True)]
    squares, covers = [(z**2).mean(axis=0) for z in scaled], [(np.abs(z) < 1.96).mean(axis=0) for z in scaled]
    by_trial, cover = np.array(squares), 100.0 * np.mean(covers, axis=0)
    for name, square, share in (
        ("tilt", by_trial[:, :2].mean(axis=1), float(cover[:2].mean())),
        ("heading", by_trial[:, 2], float(cover[2])),
    ):
        ratio = float(np.sqrt(square.mean()))
        yield Check(f"BROAD, {kind}: error / stated sd, {name}", ratio, 0.7, ">=")
        yield Check(f"BROAD, {kind}: error / stated sd, {name}, not more", ratio, 1.4, "<=")
        alone = float(np.sqrt(square).mean())
        yield Check(f"BROAD, {kind}: error / stated sd, {name}, mean of each trial's", alone, np.inf, "<=")
        yield Check(f"BROAD, {kind}: cover of 95 % intervals, {name}", share, 90.0, ">=", "%")
        yield Check(f"BROAD, {kind}: cover, {name}, not more", share, 98.0, "<=", "%")


def standardised(course: Orientation, one: ImuReadings) -> Array:
    """(n, 3) errors about north, west and up over their stated spreads, in the n samples of movement.

    Args:
        course: The orientation.
        one: The readings with their reference.
    """
    assert one.orientation is not None and one.moving is not None and course.sd_rad is not None
    truth = change_frame(one.orientation, "ENU", "NWU")
    there = one.moving & np.isfinite(truth).all(axis=1)
    off = multiply(change_frame(course.quaternion, "ENU", "NWU")[there], conjugate(truth[there]))
    return np.asarray(2.0 * np.where(off[:, 3:] < 0.0, -off, off)[:, :3] / course.sd_rad[there])


def _starts(sensors: Sequence[ImuReadings]) -> Iterator[Check]:
    """Pieces that start in motion, with a bias of 0.5°/s added in a random direction."""
    rng = np.random.default_rng(0)
    pieces = []
    for one in sensors:
        for first in _moving_samples(one):
            axis = rng.normal(size=3)
            pieces.append(_piece(one, first, BIAS_RAD_S * axis / np.linalg.norm(axis)))
    own = orientations(pieces, frame="ENU", settings=OrientSettings("ekf"))
    mine = [_error(course.quaternion, one).total for course, one in zip(own, pieces, strict=True)]
    theirs = [_error(_vqf(one, "ekf"), one).total for one in pieces]
    name = f"BROAD, {len(pieces)} starts in motion with 0.5 deg/s of bias"
    yield _degrees(f"{name}: total", float(np.mean(mine)))
    yield _degrees(f"{name}, VQF: total", float(np.mean(theirs)))
    yield Check(f"{name}: total / VQF's", float(np.mean(mine) / np.mean(theirs)), 1.0, "<=")


def _moving_samples(one: ImuReadings) -> list[int]:
    """First samples of pieces, spread over the movement."""
    assert one.moving is not None
    rate = np.linalg.norm(np.nan_to_num(one.angular_velocity_rad_s), axis=1)
    mean = np.convolve(rate, np.ones(100) / 100.0, mode="same")
    last = one.samples - round(CUT_S * one.rate_hz)
    fast = mean > (TURNING_RAD_S if (mean > TURNING_RAD_S).mean() > 0.1 else 0.3)
    there = np.flatnonzero((fast & one.moving)[:last])
    return [int(there[k]) for k in np.linspace(0, len(there) - 1, CUTS).astype(int)]


def _piece(one: ImuReadings, first: int, bias: Array) -> ImuReadings:
    cut = slice(first, first + round(CUT_S * one.rate_hz))
    assert one.orientation is not None and one.moving is not None and one.magnetic_field is not None
    return ImuReadings(
        f"{one.name} from {first}",
        one.time_s[cut],
        one.specific_force_mps2[cut],
        one.angular_velocity_rad_s[cut] + bias,
        one.magnetic_field[cut],
        one.rate_hz,
        one.frame,
        one.orientation[cut],
        one.moving[cut],
    )
