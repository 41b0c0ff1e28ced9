"""A stream as the objects of Vicon's DataStream describe it: rate, subjects' markers, axis that points up, plates."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.errors import InvalidInput, InvalidPacket, UnknownName
from mbkf.io.axes import rotation_to_world
from mbkf.io.plate_corners import has_area
from mbkf.io.records import PlateReadings
from mbkf.io.wrench import DEFAULT_COP_THRESHOLD_N
from mbkf.stream.source import FARTHEST_M, StreamDescription, empty_plate
from mbkf.stream.vicon import objects
from mbkf.stream.vicon.objects import Plate, Subject

TICKS_PER_S = 135_000_000
"""Vicon's clock, in whose ticks periods are stated."""

MM = 1e-3
"""Places are millimetres."""

RATES_HZ = (1.0, 100_000.0)

MOST_MARKERS, MOST_PLATES = 5000, 64

LISTS_KEPT = 16
"""Lists of markers whose places are kept, at most."""

FORCE_NAMES = ("Fx", "Fy", "Fz")
"""Components of the channel by which a device is a force plate."""


@dataclass(frozen=True)
class ViconPlate:
    """A plate.

    Attributes:
        device: Its ID.
        rotation: (3, 3) from its axes to the world's.
        origin_m: (3,) its origin in the world.
        sensor_m: (3,) point of its transducers in the world.
        period: Ticks of one of its own frames.
        samples: Samples in one of its own frames.
    """

    device: int
    rotation: Array
    origin_m: Array
    sensor_m: Array
    period: int
    samples: int


@dataclass(frozen=True)
class ViconDescription:
    """A stream's description.

    Attributes:
        stream: Its description.
        places: Place of each marker in it, by IDs of subject and marker.
        plates: (K,) the plates.
        rotation: (3, 3) from Vicon's axes to the world's.
        left_out: Sentences on plates that cannot be read.
    """

    stream: StreamDescription
    places: Mapping[tuple[int, int], int]
    plates: tuple[ViconPlate, ...]
    rotation: Array
    left_out: tuple[str, ...] = ()

    @cached_property
    def to_world(self) -> Array:
        """(3, 3) matrix that takes rows of places in Vicon's axes, mm, to the world's, m."""
        return MM * self.rotation.T

    @cached_property
    def columns(self) -> Callable[[bytes], tuple[NDArray[np.intp], NDArray[np.intp]]]:
        """Function that takes the IDs of markers, as they stand in a packet, to rows of known ones and their places.

        Frames list the same markers most often, so that the latest lists are kept.
        """
        return lru_cache(maxsize=LISTS_KEPT)(self._columns)

    def _columns(self, ids: bytes) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Rows (n,) of the known ones among the markers with these IDs, pairs of whole numbers; their places (n,)."""
        pairs = np.frombuffer(ids, "<u4").reshape(-1, 2).tolist()
        found = [
            (row, self.places[pair]) for row, pair in enumerate(map(tuple, pairs)) if pair in self.places
        ]
        rows, columns = np.array(found, dtype=np.intp).reshape(-1, 2).T
        return rows, columns


def describe(
    known: Mapping[int, Sequence[bytes]], forces: Mapping[int, int], up: str | None, person: str | None
) -> ViconDescription | None:
    """The description that objects give; None while there is no frame rate.

    Args:
        known: Latest objects by type.
        forces: Samples in a frame of each device, by its ID.
        up: Axis that points up; None for the one that is stated.
        person: Subject to follow; None for all of them.

    Raises:
        InvalidInput: The rate is impossible.
        InvalidPacket: An object cannot be read.
        UnknownName: There is no such subject or axis.
    """
    if objects.STREAM_INFO not in known:
        return None
    period = objects.Fields(known[objects.STREAM_INFO][0]).long_integer()
    if not period:
        return None  # no cameras run
    rate_hz = TICKS_PER_S / period
    if not RATES_HZ[0] <= rate_hz <= RATES_HZ[1]:
        raise InvalidInput(f"Vicon: the frame rate is stated as {rate_hz:g} Hz; start the cameras or a trial")
    subjects = [objects.read_subject(one) for one in known.get(objects.SUBJECT_INFO, ())]
    names, places = _markers(subjects, person)
    stated = known.get(objects.APPLICATION_INFO, (b"\0",))[0]
    rotation = rotation_to_world(up or ("y" if stated[:1] == b"\1" else "z"))
    plates, readings, left_out = _plates(known, forces, rotation)
    stream = StreamDescription(_trial(subjects, person), names, rate_hz, 0.0, readings)
    return ViconDescription(stream, places, plates, rotation, left_out)


def _trial(subjects: Sequence[Subject], person: str | None) -> str:
    return person or (subjects[0].name if subjects else "") or "vicon"


def _markers(
    subjects: Sequence[Subject], person: str | None
) -> tuple[tuple[str, ...], dict[tuple[int, int], int]]:
    """Names of all markers, and their places by IDs. One whose name is another's has its subject's in front."""
    if person is not None:
        if person not in [one.name for one in subjects]:
            raise UnknownName("subject", person, [one.name for one in subjects], "--person")
        subjects = [one for one in subjects if one.name == person]
    count = sum(len(one.markers) for one in subjects)
    if count > MOST_MARKERS:
        raise InvalidInput(f"Vicon: {count} markers are named, more than {MOST_MARKERS}")
    names: list[str] = []
    places: dict[tuple[int, int], int] = {}
    for subject in subjects:
        for marker, name in subject.markers.items():
            places[subject.number, marker] = len(names)
            names.append(f"{subject.name}:{name}" if name in names else name)
    return tuple(names), places


def _plates(
    known: Mapping[int, Sequence[bytes]], forces: Mapping[int, int], rotation: Array
) -> tuple[tuple[ViconPlate, ...], tuple[PlateReadings, ...], tuple[str, ...]]:
    """Plates at one rate, the same without readings, and sentences on those that are left out."""
    periods = dict(objects.read_device(one) for one in known.get(objects.DEVICE_INFO, ()))
    starts = dict(objects.read_device(one) for one in known.get(objects.DEVICE_INFO_EXTRA, ()))
    channels = [objects.read_channel(one) for one in known.get(objects.CHANNEL_INFO, ())]
    measuring = {device for device, _, components in channels if components == FORCE_NAMES}
    found: list[ViconPlate] = []
    readings: list[PlateReadings] = []
    left_out: list[str] = []
    for data in known.get(objects.PLATE_INFO, ())[:MOST_PLATES]:
        try:
            plate = objects.read_plate(data)
            if plate.device not in measuring or not periods.get(plate.device):
                continue
            samples = forces.get(plate.device, 0)
            if not samples:
                left_out.append(f"plate {plate.device} sends no forces and is left out")
                continue
            one = _placed(plate, rotation, periods[plate.device], samples)
            corners = _corners(plate, rotation)
        except InvalidPacket as error:
            left_out.append(f"a plate cannot be read and is left out ({error})")
            continue
        start_s = starts.get(plate.device, 0) / TICKS_PER_S
        rate_hz = TICKS_PER_S * samples / periods[plate.device]
        if not RATES_HZ[0] <= rate_hz <= RATES_HZ[1] or corners is None:
            left_out.append(f"plate {plate.device} has no possible place, size or rate and is left out")
        elif readings and (rate_hz, start_s) != (readings[0].rate_hz, readings[0].start_time_s):
            left_out.append(
                f"plate {plate.device} has another rate or start than the first plate and is left out"
            )
        else:
            found.append(one)
            name = str(len(readings) + 1)
            readings.append(
                empty_plate(name, rate_hz, start_s, one.origin_m, DEFAULT_COP_THRESHOLD_N, corners)
            )
    return tuple(found), tuple(readings), tuple(left_out)


def _placed(plate: Plate, rotation: Array, period: int, samples: int) -> ViconPlate:
    turn = rotation @ plate.rotation
    origin = MM * rotation @ plate.translation_mm
    return ViconPlate(plate.device, turn, origin, origin + MM * turn @ plate.sensor_mm, period, samples)


def _corners(plate: Plate, rotation: Array) -> Array | None:
    """(4, 3) corners of a plate's upper side in the world; None where it has no area there."""
    turn = rotation @ plate.rotation
    least, most = _bounds(plate)
    side = most if turn[2, 2] > 0.0 else least
    x, y, z = np.array([least[0], most[0]]), np.array([least[1], most[1]]), side[2]
    local = np.array([[x[1], y[1], z], [x[0], y[1], z], [x[0], y[0], z], [x[1], y[0], z]])
    corners = MM * (rotation @ plate.translation_mm + local @ turn.T)
    upright = np.allclose(turn @ turn.T, np.eye(3), atol=1e-3)
    return corners if upright and np.isfinite(corners).all() and has_area(corners, FARTHEST_M) else None


def _bounds(plate: Plate) -> Array:
    """(2, 3) least and largest coordinates, which some programs may state axis by axis."""
    stated = plate.bounds_mm
    by_axis = stated.reshape(3, 2).T
    return by_axis if (stated[0] > stated[1]).any() and (by_axis[0] <= by_axis[1]).all() else stated
