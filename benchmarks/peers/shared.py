"""The frames and markers that all tools read: a capture with its person, and the same readings in OpenSim's axes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.dynamic.captures import SOURCES, Person, load
from mbkf.conventions import Array
from mbkf.io.storage import read_storage
from mbkf.io.subject import match_names

WALK, RUN, GAIT2354 = "rajagopal walk", "rajagopal run", "gait2354"
CAPTURES = (WALK, RUN, GAIT2354)

FEET = ("calcn_r", "calcn_l")
"""Bodies that the reactions act on."""


@dataclass(frozen=True)
class Loads:
    """Ground reactions as OpenSim's tools read them.

    Attributes:
        file: The recorded forces (.mot).
        columns: Beginning of the columns of force, point and free moment, of the right and the left foot.
    """

    file: Path
    columns: tuple[tuple[str, str, str], ...]

    def at(self, times_s: Array) -> Array:
        """(T, 2, 3, 3) force N, point m and free moment N m on right and left foot, OpenSim's axes."""
        table = read_storage(self.file)
        series = [table.column(f"{start}{axis}") for foot in self.columns for start in foot for axis in "xyz"]
        found = np.array([np.interp(times_s, table.times_s, one) for one in series])
        return np.asarray(found.T.reshape(len(times_s), len(self.columns), 3, 3))


COLUMNS = {
    WALK: tuple((f"ground_force_{s}_v", f"ground_force_{s}_p", f"ground_torque_{s}_") for s in "rl"),
    RUN: tuple((f"{s}_ground_force_v", f"{s}_ground_force_p", f"{s}_ground_torque_") for s in "RL"),
    GAIT2354: tuple((f"{s}ground_force_v", f"{s}ground_force_p", f"{s}ground_torque_") for s in ("", "1_")),
}
"""As the external loads (XML) beside the captures name them."""


@dataclass(frozen=True)
class Shared:
    """A capture as every tool gets it.

    Attributes:
        name: Name in :data:`benchmarks.dynamic.captures.SOURCES`.
        person: The capture, with no marker that one of the tools' bodies lacks, and mbkf's scaled subject, whose
            markers are not corrected yet.
        names: (M,) markers as the file names them, in the order in which mbkf follows them.
        lab_m: (T, M, 3) their positions in OpenSim's axes (x forward, y up, z right), m.
        loads: Ground reactions.
    """

    name: str
    person: Person
    names: tuple[str, ...]
    lab_m: Array
    loads: Loads

    @property
    def times_s(self) -> Array:
        """(T,) times of the frames."""
        return self.person.capture.markers.times_s

    @property
    def rate_hz(self) -> float:
        """Frame rate."""
        return self.person.capture.markers.rate_hz


def shared(name: str, data: Path, known: set[str]) -> Shared:
    """Reads a capture and keeps the markers that all tools know.

    Args:
        name: Name of the capture.
        data: Folder of the reference captures.
        known: Markers of the peers' model, as the file names them.
    """
    person = load(name, data, correct=False)
    found = match_names(person.capture.markers.names, person.subject.markers)
    names = tuple(own for own in found if own in known)
    markers = person.capture.markers.select(names)
    source = SOURCES[name]
    assert source.forces is not None
    return Shared(
        name,
        replace(person, capture=replace(person.capture, markers=markers)),
        names,
        to_opensim(markers.positions_m),
        Loads(data / source.folder / source.forces, COLUMNS[name]),
    )


def to_opensim(vectors: Array) -> Array:
    """Vectors (..., 3) of mbkf's world (x forward, y left, z up) in OpenSim's axes (x forward, y up, z right)."""
    return np.stack([vectors[..., 0], vectors[..., 2], -vectors[..., 1]], axis=-1)
