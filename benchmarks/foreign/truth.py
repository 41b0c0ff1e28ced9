"""Persons made from bodies of OpenSim, with exact truth: their files, and coordinates under OpenSim's names.

A person's folder holds ``static.trc``, ``person.json`` (its mass) and one folder a motion with ``trial.trc``,
``grf.mot``, ``exact.trc`` and ``truth.npz``.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from mbkf.conventions import SIDES, Array
from mbkf.errors import FileFormatError, UnknownName
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture, MarkerTrajectories

FOLDER = "foreign_truth"
"""Below the folder of reference captures."""

TO_OURS = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""From OpenSim's axes (y up, z to the right) to ours (z up, y to the left)."""


@dataclass(frozen=True)
class Truth:
    """What a motion truly was.

    Attributes:
        times_s: (T,) times.
        names: (C,) OpenSim's coordinates.
        q: (T, C) their values, rad and m.
        tau: (T, C) their generalised forces, N m and N.
        knee_flexion, knee_adduction: Moments about the knee's anatomical axes by side, (T,) N m.
        mass_kg: Mass of the person.
        exact: Exact places of markers, some of which the trial lacks.
    """

    times_s: Array
    names: tuple[str, ...]
    q: Array
    tau: Array
    knee_flexion: dict[str, Array]
    knee_adduction: dict[str, Array]
    mass_kg: float
    exact: MarkerTrajectories

    def coordinate(self, name: str) -> Array:
        """(T,) a coordinate, rad or m.

        Raises:
            UnknownName: The body has no such coordinate.
        """
        return self.q[:, self._column(name)]

    def moment(self, name: str) -> Array:
        """(T,) the moment of a coordinate, N m; that of a knee about its anatomical axes.

        Raises:
            UnknownName: The body has no such coordinate.
        """
        joint, side = name[:-2], name[-1]
        about = {"knee_angle": self.knee_flexion, "knee_adduction": self.knee_adduction}.get(joint)
        return self.tau[:, self._column(name)] if about is None else about[side]

    def has(self, name: str) -> bool:
        """True where the body has a coordinate."""
        return name in self.names

    def pelvis(self) -> tuple[Array, Array]:
        """Rotations (T, 3, 3) and origins (T, 3) of the pelvis in OpenSim's axes."""
        turned = _turned([self.coordinate(f"pelvis_{turn}") for turn in ("tilt", "list", "rotation")])
        return turned, np.column_stack([self.coordinate(f"pelvis_t{axis}") for axis in "xyz"])

    def thigh_in_pelvis(self, side: str) -> Array:
        """(T, 3, 3) rotations of a thigh in the pelvis: about z, x and y, the last two mirrored on the left."""
        mirror = 1.0 if side == "r" else -1.0
        flexion, adduction, turn = (
            self.coordinate(f"hip_{angle}_{side}") for angle in ("flexion", "adduction", "rotation")
        )
        return _turned([flexion, mirror * adduction, mirror * turn])

    def _column(self, name: str) -> int:
        if name not in self.names:
            raise UnknownName("coordinate", name, self.names)
        return self.names.index(name)


def _turned(angles: Sequence[Array]) -> Array:
    """(T, 3, 3) rotations about z, x and y in turn."""
    return np.asarray(Rotation.from_euler("ZXY", np.column_stack(angles)).as_matrix())


@dataclass(frozen=True)
class Foreigner:
    """A person who is not made from our body.

    Attributes:
        name: Name of the person.
        folder: Where the person's files are.
    """

    name: str
    folder: Path

    @property
    def motions(self) -> tuple[str, ...]:
        """Names of the recorded motions, in alphabetical order."""
        return tuple(sorted(path.parent.name for path in self.folder.glob("*/truth.npz")))

    @property
    def mass_kg(self) -> float:
        """Body mass."""
        return float(json.loads((self.folder / "person.json").read_text(encoding="utf-8"))["mass"])

    def static(self) -> Capture:
        """The standing trial."""
        return read_capture(self.folder / "static.trc")

    def trial(self, motion: str) -> Capture:
        """Markers and plates of a motion."""
        return read_capture(self.folder / motion / "trial.trc", forces=self.folder / motion / "grf.mot")

    def truth(self, motion: str) -> Truth:
        """Truth of a motion.

        Raises:
            FileFormatError: The file lacks an array.
        """
        path = self.folder / motion / "truth.npz"
        exact = read_capture(self.folder / motion / "exact.trc").markers
        with np.load(path) as held:
            found: dict[str, NDArray[np.generic]] = dict(held)
        needed = {"t", "names", "q", "tau", "mass", *(f"k{a}_{s}" for a in ("flex", "add") for s in SIDES)}
        if missing := needed - set(found):
            raise FileFormatError(path, f"it lacks the arrays {', '.join(sorted(missing))}")
        return Truth(
            np.asarray(found["t"], float),
            tuple(str(name) for name in found["names"]),
            np.asarray(found["q"], float),
            np.asarray(found["tau"], float),
            {side: np.asarray(found[f"kflex_{side}"], float) for side in SIDES},
            {side: np.asarray(found[f"kadd_{side}"], float) for side in SIDES},
            float(np.asarray(found["mass"], float)),
            exact,
        )


def foreigners(folder: Path, chosen: Sequence[str] = ()) -> list[Foreigner]:
    """The persons of a folder, in alphabetical order.

    Args:
        folder: Folder of the persons' folders.
        chosen: Names of those wanted; empty for all.

    Raises:
        UnknownName: A person does not exist.
    """
    found = {
        path.parent.name: Foreigner(path.parent.name, path.parent) for path in folder.glob("*/person.json")
    }
    for name in chosen:
        if name not in found:
            raise UnknownName("person", name, sorted(found))
    return [found[name] for name in sorted(chosen or found)]
