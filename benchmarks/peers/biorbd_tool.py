"""biorbd's extended Kalman filter of markers, and its inverse dynamics."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from benchmarks.peers.biomod import BiomodBody, biomod
from benchmarks.peers.required import biorbd, quiet
from benchmarks.peers.shared import FEET, Loads
from mbkf.conventions import Array


@dataclass(frozen=True)
class Noise:
    """The filter's two factors; those of `KalmanParam` by default: of the process's and of the markers' noise."""

    noise: float = 1e-10
    error: float = 1e-5


DEFAULT = Noise()


@dataclass(frozen=True)
class Motion:
    """A followed trial.

    Attributes:
        q, v, a: (T, n) coordinates, rates and accelerations in the body's order.
        markers_m: (T, M, 3) the model's markers, m.
    """

    q: Array
    v: Array
    a: Array
    markers_m: Array


class Tracking:
    """The filter on one trial, frame by frame."""

    def __init__(self, model: Any, lab_m: Array, rate_hz: float, noise: Noise = DEFAULT) -> None:
        """Starts with the pose of biorbd's inverse kinematics in the first frame.

        Args:
            model: biorbd's model with the trial's markers in their order.
            lab_m: (T, M, 3) their positions, m; NaN where not seen.
            rate_hz: Frame rate.
            noise: The filter's factors.
        """
        lib = biorbd()
        self.model = model
        self._flat = np.ascontiguousarray(lab_m.reshape(len(lab_m), -1))
        self._filter = lib.KalmanReconsMarkers(model, lib.KalmanParam(rate_hz, noise.noise, noise.error))
        self.q = lib.GeneralizedCoordinates(model)
        self.v = lib.GeneralizedVelocity(model)
        self.a = lib.GeneralizedAcceleration(model)
        start = lib.GeneralizedCoordinates(first_pose(model, lab_m[0]))
        still = np.zeros(model.nbQ())
        self._filter.setInitState(start, lib.GeneralizedVelocity(still), lib.GeneralizedAcceleration(still))

    def step(self, t: int) -> None:
        """A frame."""
        self._filter.reconstructFrame(self.model, self._flat[t], self.q, self.v, self.a)

    def motion(self) -> Motion:
        """The whole trial."""
        rows = []
        for t in range(len(self._flat)):
            self.step(t)
            rows.append([one.to_array() for one in (self.q, self.v, self.a)])
        q, v, a = (np.array([row[k] for row in rows]) for k in range(3))
        return Motion(q, v, a, markers(self.model, q))


def follow(body: BiomodBody, lab_m: Array, rate_hz: float, noise: Noise = DEFAULT) -> Motion:
    """Follows a trial.

    Args:
        body: The body, with the trial's markers in their order.
        lab_m: (T, M, 3) their positions, m; NaN where not seen.
        rate_hz: Frame rate.
        noise: The filter's factors.
    """
    return Tracking(read(body), lab_m, rate_hz, noise).motion()


def read(body: BiomodBody) -> Any:
    """A body as biorbd's model."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "body.bioMod"
        path.write_text(biomod(body) + "\n", encoding="utf-8")
        return biorbd().Model(str(path))


def with_markers(body: BiomodBody, names: Sequence[str]) -> BiomodBody:
    """The body with these markers only, in this order."""
    known = {marker.name: marker for marker in body.markers}
    return replace(body, markers=tuple(known[name] for name in names))


def first_pose(model: Any, seen_m: Array) -> Array:
    """(n,) coordinates of biorbd's inverse kinematics in one frame.

    Args:
        model: The model.
        seen_m: (M, 3) the frame's markers, m; NaN where not seen.
    """
    solver = biorbd().InverseKinematics(model, seen_m.T[:, :, None])
    with quiet():
        return np.asarray(solver.solve("trf"))[:, 0]


def markers(model: Any, q: Array) -> Array:
    """(T, M, 3) the model's markers in a motion (T, n), m."""
    lib = biorbd()
    return np.array([[m.to_array() for m in model.markers(lib.GeneralizedCoordinates(row))] for row in q])


def correct_markers(body: BiomodBody, lab_m: Array, rate_hz: float, rounds: int) -> BiomodBody:
    """The body with its markers where a trial shows them on their segments, as mbkf does with its own.

    Args:
        body: The body, with the trial's markers in their order.
        lab_m: (T, M, 3) their positions, m; NaN where not seen.
        rate_hz: Frame rate.
        rounds: How often the trial is followed, and each marker put at the mean of its measured places.
    """
    lib = biorbd()
    for _ in range(rounds):
        model = read(body)
        number = {model.segment(k).name().to_string(): k for k in range(model.nbSegment())}
        places: list[list[Array]] = [[] for _ in body.markers]
        motion = Tracking(model, lab_m, rate_hz).motion()
        for q, seen in zip(motion.q, lab_m, strict=True):
            frames = [one.to_array() for one in model.allGlobalJCS(lib.GeneralizedCoordinates(q))]
            for k in np.flatnonzero(~np.isnan(seen[:, 0])):
                pose = frames[number[body.markers[k].body]]
                places[k].append(pose[:3, :3].T @ (seen[k] - pose[:3, 3]))
        moved = [
            replace(marker, place_m=np.mean(some, axis=0)) if some else marker
            for marker, some in zip(body.markers, places, strict=True)
        ]
        body = replace(body, markers=tuple(moved))
    return body


def inverse_dynamics(model: Any, motion: Motion, times_s: Array, loads: Loads) -> Array:
    """(T, n) generalised forces, N and N m.

    Args:
        model: The model.
        motion: Its motion.
        times_s: (T,) times of the frames.
        loads: Ground reactions.
    """
    lib = biorbd()
    wrenches = loads.at(times_s)
    found = []
    for t in range(len(times_s)):
        external = model.externalForceSet()
        for foot, (force, point, torque) in zip(FEET, wrenches[t], strict=True):
            external.add(foot, np.concatenate([torque, force]), point)
        q = lib.GeneralizedCoordinates(motion.q[t])
        v, a = lib.GeneralizedVelocity(motion.v[t]), lib.GeneralizedAcceleration(motion.a[t])
        found.append(model.InverseDynamics(q, v, a, external).to_array())
    return np.array(found)
