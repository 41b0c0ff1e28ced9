"""Faults of markers: axes, unit and rate of the file, slipped and hidden markers, noise and ghosts, another person."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.verdict.faults.names import FROM_FRAME, any_leg
from benchmarks.verdict.recorded import Recorded
from mbkf.conventions import Array
from mbkf.io.records import Capture
from mbkf.numerics.runs import runs
from mbkf.trial.scale import scale

STATURES = (0.85, 0.9, 1.1, 1.15)
"""Heights of other persons over that of the right one."""

UNITS = (("m as mm", 1e-3), ("mm as m", 1e3), ("cm as inches", 2.54), ("inches as cm", 1.0 / 2.54))
TURNS = ((90, "z"), (180, "z"), (270, "z"), (90, "x"), (270, "x"), (90, "y"))
"""Degrees and axis by which markers are turned against the laboratory."""

SLIP_M, STATIC_SLIP_M = (0.03, 0.08), (0.03, 0.06)
"""Displacements of a marker that fell off and was put back, and of markers placed anew after the standing trial."""

HIDDEN_S, HIDDEN_SHARE = 0.5, 0.5
NOISE_M, GHOSTS, GHOST_S, GHOST_M = 0.015, 0.15, 0.05, 0.4


def with_positions(recorded: Recorded, positions_m: Array) -> Recorded:
    """The trial with other positions (T, M, 3) of its markers."""
    markers = replace(recorded.capture.markers, positions_m=positions_m)
    return replace(recorded, capture=replace(recorded.capture, markers=markers))


def another_person(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """The subject file belongs to a taller or shorter person."""
    factor = STATURES[int(rng.integers(len(STATURES)))]

    def larger(capture: Capture) -> Capture:
        positions = factor * capture.markers.positions_m
        return replace(capture, markers=replace(capture.markers, positions_m=positions), plates=())

    person = scale(
        None if recorded.static is None else larger(recorded.static),
        [larger(one) for one in recorded.trials],
        mass_kg=recorded.subject.mass_kg * factor**2,
    )
    return replace(recorded, subject=person), f"{100.0 * (factor - 1.0):+.0f} % taller"


def wrong_unit(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """Markers are read in a wrong unit."""
    name, factor = UNITS[int(rng.integers(len(UNITS)))]
    return with_positions(recorded, factor * recorded.capture.markers.positions_m), name


def wrong_axes(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """Markers are turned against the laboratory, or mirrored from left to right."""
    positions = recorded.capture.markers.positions_m
    k = int(rng.integers(len(TURNS) + 1))
    if k == len(TURNS):
        return with_positions(recorded, positions * [1.0, -1.0, 1.0]), "mirrored from left to right"
    degrees, axis = TURNS[k]
    turn = Rotation.from_euler(axis, degrees, degrees=True).as_matrix()
    return with_positions(recorded, positions @ turn.T), f"turned by {degrees}° about {axis}"


def wrong_rate(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """The file states half or twice the rate of the cameras, or of all instruments."""
    factor, every = (0.5, 2.0)[int(rng.integers(2))], bool(rng.integers(2))
    capture, markers = recorded.capture, recorded.capture.markers
    plates = capture.plates
    if every:
        plates = tuple(
            replace(one, rate_hz=factor * one.rate_hz, start_time_s=one.start_time_s / factor)
            for one in plates
        )
    start_s = markers.start_time_s / factor if every else markers.start_time_s
    changed = replace(markers, rate_hz=factor * markers.rate_hz, start_time_s=start_s)
    of = "all instruments" if every else "cameras"
    return replace(
        recorded, capture=replace(capture, markers=changed, plates=plates)
    ), f"{factor:g} times, {of}"


def slipped(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """A marker of a leg is displaced from a frame on."""
    name = str(rng.choice(any_leg(recorded, rng)))
    first = round(float(rng.uniform(*FROM_FRAME)) * recorded.capture.markers.frames)
    by = _away(rng, SLIP_M)
    positions = recorded.capture.markers.positions_m.copy()
    # In the laboratory's axes: a marker that hangs down from its tape does not turn with the segment either.
    positions[first:, recorded.capture.markers.names.index(name)] += by
    return with_positions(
        recorded, positions
    ), f"{name} by {1e3 * np.linalg.norm(by):.0f} mm from frame {first} on"


def static_of_another_set(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """Three markers of each leg were placed anew after the standing trial."""
    assert recorded.static is not None
    static, moved = recorded.static, []
    positions = static.markers.positions_m.copy()
    for _ in range(6):
        name = str(rng.choice(any_leg(recorded, rng)))
        if name in static.markers.names:
            positions[:, static.markers.names.index(name)] += _away(rng, STATIC_SLIP_M)
            moved.append(name)
    changed = replace(static, markers=replace(static.markers, positions_m=positions))
    return replace(recorded, static=changed, scale_again=True), ", ".join(dict.fromkeys(moved))


def hidden(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """Half of the samples of a leg are missing in long gaps, all of them for half a second."""
    names, markers = any_leg(recorded, rng), recorded.capture.markers
    positions = markers.positions_m.copy()
    length = round(HIDDEN_S * markers.rate_hz)
    begin = int(rng.integers(1, max(2, markers.frames - length)))
    for name in names:
        own = markers.names.index(name)
        positions[begin : begin + length, own] = np.nan
        while np.isfinite(positions[:, own, 0]).mean() > 1.0 - HIDDEN_SHARE:
            at = int(rng.integers(1, markers.frames))
            positions[at : at + length, own] = np.nan
    # A body is found in the first frame.
    positions[0] = markers.positions_m[0]
    return with_positions(recorded, positions), f"{len(names)} markers, all of them from frame {begin} on"


def ghosts(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """Markers jitter by 15 mm, or jump to reflections beside the body for some frames at a time."""
    markers = recorded.capture.markers
    positions = markers.positions_m.copy()
    if rng.random() < 0.5:
        return with_positions(
            recorded, positions + rng.normal(0.0, NOISE_M, positions.shape)
        ), "noise of 15 mm"
    steps = max(1, round(GHOST_S * markers.rate_hz))
    for m in range(len(markers.names)):
        jumps = np.repeat(rng.random(markers.frames // steps + 1) < GHOSTS, steps)[: markers.frames]
        for first, after in runs(jumps):
            positions[first:after, m] += rng.normal(0.0, GHOST_M, 3)
    return with_positions(recorded, positions), "reflections in 15 % of the samples"


def _away(rng: np.random.Generator, sizes_m: tuple[float, float]) -> Array:
    direction = rng.normal(size=3)
    return np.asarray(float(rng.uniform(*sizes_m)) * direction / np.linalg.norm(direction))


def moved(capture: Capture, by_m: Array) -> Capture:
    """A capture whose plates lie elsewhere.

    Args:
        capture: The capture.
        by_m: (3,) displacement.
    """
    plates = tuple(
        replace(
            one,
            origin_m=one.origin_m + by_m,
            centre_of_pressure_m=one.centre_of_pressure_m + by_m,
            corners_m=None if one.corners_m is None else one.corners_m + by_m,
        )
        for one in capture.plates
    )
    return replace(capture, plates=plates)
