"""A simulated network streamer of Xsens MVN: a motion of the body as datagrams of segments and trackers.

Written from Xsens' MVN real-time network streaming Protocol Specification, revision N: big endian, a header
of 24 bytes, 23 segments by ID (index + 1), z up, quaternions with the real part first; a sample that does not fit into
a datagram is split, its last part marked by the highest bit of the datagram counter. In MVN's T-pose all segments have
the axes of the world. Positions are metres, as in recorded packets of type 02; section 2.5.6 names centimetres, which
``unit`` plays.
"""

from __future__ import annotations

import socket
import struct
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.conventions import Array
from mbkf.model.body import Body

BODY = {
    "Pelvis": "pelvis", "L5": "torso", "L3": "torso", "T12": "torso", "T8": "torso", "Neck": "neck", "Head": "head",
    "Right Shoulder": "torso", "Right Upper Arm": "right_upper_arm", "Right Forearm": "right_forearm",
    "Right Hand": "right_hand", "Left Shoulder": "torso", "Left Upper Arm": "left_upper_arm",
    "Left Forearm": "left_forearm", "Left Hand": "left_hand", "Right Upper Leg": "right_thigh",
    "Right Lower Leg": "right_shank", "Right Foot": "right_foot", "Right Toe": "right_toes",
    "Left Upper Leg": "left_thigh", "Left Lower Leg": "left_shank", "Left Foot": "left_foot", "Left Toe": "left_toes",
}  # fmt: skip
"""MVN's segments in their order, and the body's that move with them."""

ARMS = ("upper_arm", "forearm", "hand")
"""Parts that lie along y in MVN's T-pose, and hang in the body's neutral one."""

CARRYING = (1, 5, 7, 9, 10, 13, 14, 16, 17, 18, 20, 21, 22)
"""IDs of segments that carry a tracker here."""

MOST_BYTES = 1500
"""Payload of a datagram, at most."""

CHEST_M = 0.22
"""Height of T8's origin above the joint of the one trunk segment here."""


@dataclass(frozen=True)
class Suit:
    """The course of MVN's segments.

    Attributes:
        rate_hz: Samples per second.
        places_m: (T, 23, 3) origins in MVN's world.
        turns: (T, 23, 4) quaternions segment → world, w first.
        free_mps2: (T, 23, 3) accelerations of the origins in the world, without gravity.
    """

    rate_hz: float
    places_m: Array
    turns: Array
    free_mps2: Array

    def __len__(self) -> int:
        return len(self.places_m)


def suit_of(model: Body, q: Array, rate_hz: float, heading_rad: float = 0.6) -> Suit:
    """The segments of a motion in a world of MVN's own, turned about the vertical and shifted.

    Args:
        model: The body.
        q: (T, nq) its configurations.
        rate_hz: Their rate.
        heading_rad: Heading of the body's x axis in MVN's world.
    """
    joints = [model.joint(name).joint_id for name in BODY.values()]
    laid = [Rotation.identity() if not name.endswith(ARMS) else _laid(name) for name in BODY.values()]
    hips = [model.joint(name).joint_id for name in ("right_thigh", "left_thigh")]
    world, shift = Rotation.from_euler("z", heading_rad), np.array([1.5, -0.8, 0.0])
    places, turns = [], []
    for one in q:
        R, p = model.placements(one)
        own = [Rotation.from_matrix(R[joint]) for joint in joints]
        at = p[joints].copy()
        at[0] = p[hips].mean(axis=0)
        at[4] += CHEST_M * R[joints[4]][:, 2]
        places.append(world.apply(at) + shift)
        turns.append([(world * a * b).as_quat()[[3, 0, 1, 2]] for a, b in zip(own, laid, strict=True)])
    found = np.array(places)
    free = rate_hz**2 * np.gradient(np.gradient(found, axis=0), axis=0)
    return Suit(rate_hz, found, np.array(turns), free)


def _laid(name: str) -> Rotation:
    """Turn of an arm's T-pose axes against those of the hanging arm."""
    return Rotation.from_euler("x", 90.0 if name.startswith("right") else -90.0, degrees=True)


class XsensServer:
    """Sends samples to one receiver.

    Attributes:
        suit: What it plays.
        character: ID of the person.
    """

    def __init__(self, suit: Suit, port: int, address: str = "127.0.0.1", character: int = 0) -> None:
        """A streamer that has sent nothing.

        Args:
            suit: What is played.
            port: Port of the receiver.
            address: Its address.
            character: ID of the person.
        """
        self.suit, self.character = suit, character
        self._place = (address, port)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def send(self, data: bytes) -> None:
        """Sends a datagram."""
        self._socket.sendto(data, self._place)

    def play(self, frame: int, kinds: Sequence[int] = (2,), number: int | None = None) -> None:
        """Sends a sample of some types.

        Args:
            frame: The suit's frame.
            kinds: The types.
            number: MVN's count; that of the frame by default.
        """
        for kind in kinds:
            for data in self.sample(frame, kind, frame if number is None else number):
                self.send(data)

    def sample(
        self, frame: int, kind: int, number: int, *, most: int = MOST_BYTES, unit: float = 1.0
    ) -> list[bytes]:
        """The datagrams of a sample.

        Args:
            frame: The suit's frame.
            kind: 2 segments, 23 trackers, 24 centre of mass, 25 time code, 12 the person's name, 20 joint angles.
            number: MVN's count.
            most: Bytes of a datagram's payload.
            unit: Of lengths, per metre.
        """
        time_ms = round(1e3 * frame / self.suit.rate_hz)
        items = self._items(frame, kind, unit)
        size = len(items[0])
        per = max(1, most // size)
        parts = [items[at : at + per] for at in range(0, len(items), per)]
        return [
            self.header(
                kind, number, k | (0x80 if k == len(parts) - 1 else 0), len(part), time_ms, len(part) * size
            )
            + b"".join(part)
            for k, part in enumerate(parts)
        ]

    def header(self, kind: int, number: int, counter: int, items: int, time_ms: int, size: int) -> bytes:
        """24 bytes: identification, sample counter, datagram counter, items, clock, person, counts of segments.

        Args:
            kind: Type of the data.
            number: Sample counter.
            counter: Datagram counter.
            items: Number of items.
            time_ms: Clock.
            size: Bytes that follow.
        """
        start = f"MXTP{kind:02d}".encode() + struct.pack(">IBBI", number % 2**32, counter, items, time_ms)
        return start + struct.pack(">BBBBHH", self.character, 23, 0, 0, 0, size)

    def close(self) -> None:
        """Sends no more."""
        self._socket.close()

    def _items(self, frame: int, kind: int, unit: float) -> list[bytes]:
        suit = self.suit
        if kind == 2:
            return [
                struct.pack(">I3f4f", k + 1, *(unit * suit.places_m[frame, k]), *suit.turns[frame, k])
                for k in range(23)
            ]
        if kind == 23:
            return [
                struct.pack(
                    ">I4f3f3f", k, *suit.turns[frame, k - 1], *suit.free_mps2[frame, k - 1], 0.4, 0.0, -0.9
                )
                for k in CARRYING
            ]
        if kind == 20:
            return [struct.pack(">II3f", 257, 513, 1.0, 2.0, 3.0)] * 22
        texts = {12: b"name:Person\nxmid:00600123\ncolor:00FF00\n", 25: b"10:11:12.345"}
        return [texts.get(kind, struct.pack(">3f", 0.0, 0.0, 0.9))]
