"""Captures of a made person: markers on moving skin, misplaced, noisy and with gaps, and plates; written as files."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator

from benchmarks.foreign.making.drivers import driven
from benchmarks.foreign.making.loads import LEAST_FORCE_N, pressure
from benchmarks.foreign.making.osim_body import OsimBody
from benchmarks.foreign.making.persons import HIDDEN, Person
from benchmarks.foreign.making.record import RATE_HZ, Recorded, standing_points
from benchmarks.foreign.making.skin import MAKERS, amplitude_m, of_size
from benchmarks.foreign.truth import TO_OURS
from mbkf.conventions import SIDES, Array
from mbkf.io.records import MarkerTrajectories
from mbkf.io.storage import Table, write_storage
from mbkf.io.trc import write_trc

NOISE_M = 0.0005
MISPLACED_M = 0.004
"""Standard deviation along each axis: 7 mm in space."""

GAPS, GAP_FRAMES = (0.03, 0.05), (5, 30)
"""Share of samples that are missing, and how many in a row."""

STATIC_S, PLATE_HZ = 1.5, 400.0


@dataclass(frozen=True)
class Placed:
    """Bodies and markers over a movement, in OpenSim's axes.

    Attributes:
        frames: Rotations (T, 3, 3) and origins (T, 3) by body.
        exact_m: (T, M, 3) places of the markers on bone.
    """

    frames: Mapping[str, tuple[Array, Array]]
    exact_m: Array


def placed(body: OsimBody, q: Array, names: tuple[str, ...]) -> Placed:
    """Places over a movement.

    Args:
        body: The body.
        q: (T, C) coordinates.
        names: (M,) markers.
    """
    parts = sorted({body.marker_body(name) for name in names})
    turned: dict[str, list[Array]] = {part: [] for part in parts}
    origins: dict[str, list[Array]] = {part: [] for part in parts}
    exact = []
    for pose in q:
        body.move(pose)
        exact.append(body.markers(names))
        for part in parts:
            rotation, origin = body.frame(part)
            turned[part].append(rotation)
            origins[part].append(origin)
    frames = {part: (np.array(turned[part]), np.array(origins[part])) for part in parts}
    return Placed(frames, np.array(exact))


def on_skin(
    person: Person,
    body: OsimBody,
    model: str,
    stand: Array,
    movements: Mapping[str, tuple[Array, Placed]],
    seed: int,
    sizing: int | None = None,
) -> dict[str, Array]:
    """(T, M, 3) displacements of the markers by movement, in OpenSim's axes of the ground.

    Args:
        person: The person.
        body: The person's body.
        model: Key of :data:`benchmarks.foreign.making.skin.MAKERS`.
        stand: (C,) the standing posture.
        movements: Coordinates and places by movement.
        seed: Chooses the skin.
        sizing: The size of the skin's displacements is that in the first so many movements; None for all.
    """
    names = person.markers(body)
    on = np.array([body.marker_body(name) for name in names])
    found = {name: np.zeros(where.exact_m.shape) for name, (_, where) in movements.items()}
    for k, part in enumerate(sorted(set(on))):
        mine = np.flatnonzero(on == part)
        first = next(iter(movements.values()))[1]
        rotation, origin = first.frames[part]
        local = (first.exact_m[0, mine] - origin[0]) @ rotation[0]
        skin = MAKERS[model](part, local, np.random.default_rng([seed, k]))
        moved = [
            skin(driven(body, part, q, stand, where.frames[part]), 1.0 / RATE_HZ)
            for q, where in movements.values()
        ]
        sized = of_size(moved, person.skin * amplitude_m(part), sizing)
        for (name, (_, where)), one in zip(movements.items(), sized, strict=True):
            found[name][:, mine] = np.einsum("tij,tmj->tmi", where.frames[part][0], one)
    return found


def misplacements(names: tuple[str, ...], rng: np.random.Generator) -> dict[str, Array]:
    """(3,) by marker: how far it is from the protocol's place, in the axes of its body.

    Args:
        names: The markers.
        rng: Draws them.
    """
    return {name: MISPLACED_M * rng.normal(size=3) for name in names}


def shifted(body: OsimBody, names: tuple[str, ...], where: Placed, away: Mapping[str, Array]) -> Array:
    """(T, M, 3) misplacements in the axes of the ground.

    Args:
        body: The body.
        names: (M,) markers.
        where: Places of a movement.
        away: Misplacements by marker in the axes of its body.
    """
    return np.stack([where.frames[body.marker_body(name)][0] @ away[name] for name in names], axis=1)


def with_gaps(places_m: Array, rng: np.random.Generator) -> Array:
    """(T, M, 3) places of which a few per cent are missing in runs.

    Args:
        places_m: (T, M, 3) places.
        rng: Draws the gaps.
    """
    found = places_m.copy()
    frames, markers = found.shape[:2]
    wanted = rng.uniform(*GAPS)
    while np.isnan(found[:, :, 0]).mean() < wanted:
        start, length = int(rng.integers(frames)), int(rng.integers(*GAP_FRAMES))
        found[start : start + length, int(rng.integers(markers))] = np.nan
    return found


def write_markers(path: Path, names: tuple[str, ...], places_m: Array) -> None:
    """Writes markers of OpenSim's axes.

    Args:
        path: The file.
        names: (M,) markers.
        places_m: (T, M, 3) places.
    """
    write_trc(MarkerTrajectories(names, places_m @ TO_OURS.T, RATE_HZ), path)


def write_plates(path: Path, body: OsimBody, recorded: Recorded) -> None:
    """Writes both feet's plates: force, centre of pressure on the ground below the foot, and torque there.

    Args:
        path: The file.
        body: The body.
        recorded: The loads.
    """
    times, points = recorded.motion.times_s, standing_points(body, recorded.motion)
    fine = np.arange(round(times[-1] * PLATE_HZ) + 1) / PLATE_HZ
    names, columns = [], []
    for k, side in enumerate(SIDES):
        wrench = np.asarray(PchipInterpolator(times, recorded.wrenches[:, k])(fine))
        below = np.column_stack([np.interp(fine, times, points[:, k, axis]) for axis in range(3)])
        x, z = pressure(wrench, below[:, 1])
        loaded = wrench[:, 1] > LEAST_FORCE_N
        point = np.where(loaded[:, None], np.column_stack([x, below[:, 1], z]), below)
        torque = wrench[:, 3:] - np.cross(point, wrench[:, :3])
        names += [f"ground_force_{side}_{kind}{axis}" for kind in "vp" for axis in "xyz"]
        names += [f"ground_torque_{side}_{axis}" for axis in "xyz"]
        columns.append(np.hstack([wrench[:, :3], point, torque]))
    write_storage(Table(tuple(names), fine, np.hstack(columns), True, "grf"), path)


def write_truth(path: Path, body: OsimBody, recorded: Recorded) -> None:
    """Writes the truth as the shared persons have it.

    Args:
        path: The file.
        body: The body.
        recorded: The motion and its loads.
    """
    motion = recorded.motion
    knees: dict[str, Any] = {}
    for k, side in enumerate(SIDES):
        knees |= {f"kflex_{side}": recorded.knee_flexion[:, k], f"kadd_{side}": recorded.knee_adduction[:, k]}
    arrays: dict[str, Any] = dict(
        t=motion.times_s,
        q=motion.q,
        u=recorded.u,
        names=np.array(body.names),
        tau=recorded.tau,
        W=recorded.wrenches,
        com=recorded.com_m,
        mass=np.array(body.mass_kg),
        con=motion.contacts,
        flight=~motion.contacts.any(axis=1),
        floor=np.array(0.0),
    )
    np.savez_compressed(path, **arrays, **knees)


def static_places(exact_m: Array, rng: np.random.Generator) -> Array:
    """(T, M, 3) places of a person who stands and sways by a few millimetres.

    Args:
        exact_m: (M, 3) places.
        rng: Draws the sway.
    """
    times = np.arange(round(STATIC_S * RATE_HZ)) / RATE_HZ
    phase = rng.uniform(0.0, 2.0 * np.pi, (2, 3))
    sway = sum(np.sin(2.0 * np.pi * rate * times[:, None] + phase[k]) for k, rate in enumerate((0.3, 0.7)))
    return np.asarray(exact_m[None] + (0.0015, 0.0003, 0.001) * np.asarray(sway)[:, None])


def write_person(path: Path, person: Person, body: OsimBody, stand: Array) -> None:
    """Writes mass and standing coordinates.

    Args:
        path: The file.
        person: The person.
        body: The body.
        stand: (C,) the standing posture.
    """
    held = {
        "mass": body.mass_kg,
        "marker_set": person.marker_set,
        "coords": list(body.names),
        "qstatic": stand.tolist(),
    }
    path.write_text(json.dumps(held, indent=1) + "\n", encoding="utf-8")


def seen(person: Person, names: tuple[str, ...]) -> list[int]:
    """Places of the markers that moving trials have.

    Args:
        person: The person.
        names: All markers of the person's set.
    """
    return [k for k, name in enumerate(names) if name not in HIDDEN[person.marker_set]]
