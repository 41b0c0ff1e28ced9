"""Forces of Vicon's plates as force of the plate on the body and moment about the plate's origin, world axes.

DataStream's headers state forces in N and axes of the plate. Whether they are those on the body or on the plate, in
which unit moments are, and about which point, follows from the first load: the floor presses upwards, and the moment
gives the centre of pressure that is stated beside it, from the plate's origin, in metres (the SDK's own client) or
millimetres (its headers). Until then plates count as unloaded.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.stream.source import LARGEST_COUNT, PlateSamples
from mbkf.stream.vicon.description import MM, ViconPlate
from mbkf.stream.vicon.objects import MOST_SAMPLES, DeviceSamples

LOADED_N = 50.0
"""From this vertical force on, conventions are decided."""

FARTHEST_CENTRE = 5.0
"""A centre of pressure further from the origin than this, in its own unit, is stated in millimetres."""

NEWTON_METRES = {"N m": 1.0, "N mm": 1e-3}
ORIGIN, SENSOR = "the plate's origin", "the transducers' middle"


class Convention(NamedTuple):
    """Sign of the force, unit of moments, and the point that they are about."""

    sign: float
    unit: str
    about: str

    @property
    def sentence(self) -> str:
        """The convention as a sentence."""
        forces = "forces on the body" if self.sign > 0.0 else "forces on the plate"
        return f"Vicon states {forces}, moments in {self.unit} about {self.about}"


class PlateForceReader:
    """Turns samples of plates into a run's.

    Attributes:
        convention: Decided convention; None until a plate was loaded.
    """

    def __init__(self, plates: Sequence[ViconPlate]) -> None:
        """Args: the plates."""
        self.convention: Convention | None = None
        self._plates = tuple(plates)
        self._turns: dict[tuple[int, Convention], Array] = {}

    def samples(
        self,
        forces: Sequence[DeviceSamples],
        moments: Sequence[DeviceSamples],
        centres: Sequence[DeviceSamples],
    ) -> PlateSamples:
        """(S, K, 6) samples of all plates of a packet, NaN where a plate has none.

        Args:
            forces: Forces, N.
            moments: Moments.
            centres: Centres of pressure.
        """
        whole = {(one.device, one.frame): one for one in moments}
        beside = {(one.device, one.frame): one for one in centres}
        known: list[tuple[int, int, Array]] = []
        for one in forces:
            k = next((k for k, plate in enumerate(self._plates) if plate.device == one.device), None)
            moment = whole.get((one.device, one.frame))
            if k is None or moment is None or len(moment.values) != len(one.values) or not len(one.values):
                continue
            if one.frame * len(one.values) > LARGEST_COUNT:
                continue
            own = np.concatenate((one.values, moment.values), axis=1, dtype=float)
            centre = beside.get((one.device, one.frame))
            if centre is not None and len(centre.values) == len(own):
                self._decide(own, centre.values.astype(float), self._plates[k])
            known.append((k, one.frame * len(own), own))
        return self._together([(k, at, self._decided(own, self._plates[k])) for k, at, own in known])

    def _together(self, found: Sequence[tuple[int, int, Array]]) -> PlateSamples:
        if not found:
            return PlateSamples.none(len(self._plates))
        first = min(at for _, at, _ in found)
        last = max(at + len(rows) for _, at, rows in found)
        together = min(MOST_SAMPLES, 4 * sum(len(rows) for _, _, rows in found))
        if last - first > together:  # counts that have nothing in common
            found, first, last = found[:1], found[0][1], found[0][1] + len(found[0][2])
        wrench = np.full((last - first, len(self._plates), 6), np.nan)
        for k, at, rows in found:
            wrench[at - first : at - first + len(rows), k] = rows
        return PlateSamples(np.arange(first, last, dtype=np.int64), wrench)

    def _decided(self, own: Array, plate: ViconPlate) -> Array:
        """(S, 6) wrench by the decided convention; before the first load a plate is unloaded, or not known."""
        if self.convention is not None:
            return self._wrench(own, plate, self.convention)
        unloaded = np.abs(own[:, :3] @ plate.rotation[2]) < LOADED_N
        return np.where(unloaded[:, None], 0.0, np.full((len(own), 6), np.nan))

    def _wrench(self, own: Array, plate: ViconPlate, convention: Convention) -> Array:
        """(S, 6) force of the plate on the body and moment about the plate's origin, world axes."""
        key = plate.device, convention
        if key not in self._turns:
            self._turns[key] = _to_body(plate, convention)
        return np.asarray(own @ self._turns[key])

    def _decide(self, own: Array, centres: Array, plate: ViconPlate) -> None:
        """Decides by the first loaded sample: the convention whose moment gives the centre of pressure."""
        if self.convention is not None:
            return
        vertical = own[:, :3] @ plate.rotation[2]
        loaded = (
            (np.abs(vertical) >= LOADED_N) & np.isfinite(own).all(axis=1) & np.isfinite(centres).all(axis=1)
        )
        if not loaded.any():
            return
        row = int(loaded.argmax())
        sign = 1.0 if vertical[row] > 0.0 else -1.0
        unit = MM if np.abs(centres[row]).max() > FARTHEST_CENTRE else 1.0
        at = unit * plate.rotation @ centres[row]

        def apart(convention: Convention) -> float:
            """Moment about the stated centre of pressure, without its part about the vertical, over the force, m."""
            wrench = self._wrench(own[row : row + 1], plate, convention)[0]
            about = wrench[3:] - np.cross(at, wrench[:3])
            return float(np.linalg.norm(about[:2])) / abs(float(vertical[row]))

        ways = [Convention(sign, unit, about) for about, unit in product((ORIGIN, SENSOR), NEWTON_METRES)]
        self.convention = min(ways, key=apart)


def _to_body(plate: ViconPlate, convention: Convention) -> Array:
    """(6, 6) matrix that takes rows of force and moment by a convention to those on the body, world axes."""
    found = np.zeros((6, 6))
    found[:3, :3] = convention.sign * plate.rotation.T
    found[3:, 3:] = NEWTON_METRES[convention.unit] * found[:3, :3]
    if convention.about == SENSOR:
        found[:3, 3:] = np.cross(plate.sensor_m - plate.origin_m, found[:3, :3])
    return found
