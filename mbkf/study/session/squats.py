"""Measures of a squat trial: depth, knee flexion, knee torque and the legs' shares of the load, for each repetition."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.io.results import Reconstruction
from mbkf.numerics.runs import stretches
from mbkf.study.session.loading import BodyPath, body_path
from mbkf.study.session.records import Measure

LEAST_M = 0.08
"""The centre of mass sinks by this in a squat."""

RISEN = 0.25
"""A repetition lasts while the centre of mass is lower than this share of its depth."""


def squat_measures(r: Reconstruction) -> tuple[Measure, ...]:
    """The measures of each squat of a trial; empty without a squat."""
    path = body_path(r)
    found = repetitions(path)
    if not found:
        return ()
    depth = sunk(path)
    body = {
        ("Depth", "cm"): [100.0 * float(np.nanmax(depth[run])) for run in found],
        ("Duration", "s"): [float(path.times_s[run[-1]] - path.times_s[run[0]]) for run in found],
        ("Share of the right leg", "%"): [_share(path, run) for run in found],
    }
    legs: dict[tuple[str, str], dict[str, list[float]]] = {}
    for side in "rl":
        knee, torque = f"knee_angle_{side}", r.subject.mass_kg
        if knee not in r.coordinate_names:
            continue
        angle, moment = np.rad2deg(r.angle(knee)), np.where(r.valid, r.moment(knee), np.nan) / torque
        legs.setdefault(("Knee flexion at the lowest", "deg"), {})[side] = [
            float(angle[_lowest(depth, run)]) for run in found
        ]
        legs.setdefault(("Greatest knee torque", "N m/kg"), {})[side] = [
            float(np.nanmax(np.abs(moment[run]))) if np.isfinite(moment[run]).any() else np.nan
            for run in found
        ]
    return (
        *(_measure(r.trial, name, unit, {"": values}) for (name, unit), values in body.items()),
        *(_measure(r.trial, name, unit, sides) for (name, unit), sides in legs.items()),
    )


def sunk(path: BodyPath) -> Array:
    """(T,) how far the centre of mass is below its standing height, m."""
    height = path.centre_m[:, 2]
    return np.asarray(np.nanpercentile(height, 95.0) - height if np.isfinite(height).any() else 0.0 * height)


def repetitions(path: BodyPath) -> list[Array]:
    """Frames of each squat."""
    depth = np.nan_to_num(sunk(path))
    deepest = float(depth.max()) if len(depth) else 0.0
    low = depth > RISEN * deepest
    return [run for run in stretches(low) if depth[run].max() > max(LEAST_M, 0.5 * deepest)]


def _lowest(depth: Array, run: Array) -> int:
    return int(run[np.nanargmax(depth[run])])


def _share(path: BodyPath, run: Array) -> float:
    """Share of the right leg in the vertical force of both, per cent."""
    known = run[path.known[run]]
    total = path.foot_n[known].sum()
    return float(100.0 * path.foot_n[known, 0].sum() / total) if total > 0.0 else np.nan


def _measure(trial: str, name: str, unit: str, sides: dict[str, list[float]]) -> Measure:
    values = {side: np.array(one) for side, one in sides.items()}
    return Measure(name, unit, values, {side: (trial,) * len(one) for side, one in values.items()})
