"""Orientations of a person's segments or trackers from Xsens MVN's network streamer, over UDP."""

from __future__ import annotations

import time
from collections import deque

import numpy as np

from mbkf.errors import InvalidInput, InvalidPacket
from mbkf.imu.frames import multiply
from mbkf.io.axes import rotation_to_world
from mbkf.numerics.cardan import unit_quaternions
from mbkf.stream.datagrams import Datagram, Datagrams
from mbkf.stream.source import PlateSamples, SourceFrame, StreamDescription
from mbkf.stream.xsens.description import MvnDescription, describe
from mbkf.stream.xsens.joining import MvnSample, SampleJoiner
from mbkf.stream.xsens.packets import POSES, TRACKERS, WIDTHS, MvnDatagram, read_datagram
from mbkf.stream.xsens.readings import Differences, OrientedFrame

DESCRIBED_S, FEWEST_SAMPLES = 1.0, 10
"""A stream is described by its first second, and by so many samples at least."""

VAIN_S = 2.5
"""After so long without data of a type that is read, the types that came are reported."""

MOST_KEPT = 2000
"""Samples kept for the description, at most."""

NO_POINTS = np.zeros((0, 3))


class XsensSource:
    """A :class:`mbkf.stream.source.FrameSource` of inertial sensors.

    Attributes:
        port: The port that it listens at.
        receiving: True from the first read on; what was sent before was let go of.
    """

    patient = False

    def __init__(self, port: int, local: str, *, up: str | None = None, character: int | None = None) -> None:
        """Listens at a port.

        Args:
            port: The port; 0 for any free one.
            local: Address of this computer.
            up: Axis that points up in MVN; None for the one that the posture shows.
            character: MVN's ID of the person; None for the first one.

        Raises:
            InvalidInput: The port cannot be listened at.
            UnknownName: The axis does not exist.
        """
        rotation_to_world(up or "z")
        self._datagrams = Datagrams("Xsens", local, port)
        self.port, self.receiving = self._datagrams.port, False
        self._up, self._character = up, character
        self._joiners = {POSES: SampleJoiner(), TRACKERS: SampleJoiner()}
        self._samples: dict[int, list[MvnSample]] = {POSES: [], TRACKERS: []}
        self._types: set[int] = set()
        self._first: tuple[float, int] | None = None
        self._latest_ms: int | None = None
        self._described: MvnDescription | None = None
        self._differences: Differences | None = None
        self._ready: deque[SourceFrame] = deque()

    @property
    def sender(self) -> str | None:
        """Address of the sender; None before its first readable datagram."""
        return None if self._datagrams.sender is None else self._datagrams.sender[0]

    @property
    def kind(self) -> int | None:
        """Type of the data that are read; None before the stream is described."""
        return None if self._described is None else self._described.kind

    def connect(self, timeout_s: float) -> StreamDescription | None:
        """The stream, once a second of it has come; frames flow from the first read on.

        Raises:
            InvalidInput: MVN sends no type that is read, or no possible rate.
        """
        until = time.perf_counter() + timeout_s
        while (one := self._datagrams.take(max(0.0, until - time.perf_counter()))) is not None:
            found = self._read(one)
            if found is not None and len(self._samples[found[0]]) < MOST_KEPT:
                self._samples[found[0]].append(found[1])
            self._described = self._complete(self._heard_s(one.arrival_s))
            if self._described is not None:
                self._differences = Differences(self._described.stream.rate_hz)
                for remark in self._described.remarks:
                    self._datagrams.report(*remark)
                return self._described.stream
            if time.perf_counter() > until:
                break
        return None

    def _heard_s(self, now_s: float) -> float:
        """Time since the first datagram, by the clock here or MVN's."""
        if self._latest_ms is None:
            return 0.0
        self._first = self._first or (now_s, self._latest_ms)
        return max(now_s - self._first[0], 1e-3 * (self._latest_ms - self._first[1]))

    def _complete(self, heard_s: float) -> MvnDescription | None:
        for kind in (POSES, TRACKERS):
            samples = self._samples[kind]
            if heard_s > DESCRIBED_S and len(samples) >= FEWEST_SAMPLES:
                return describe(samples, kind, self._up)
        if heard_s > VAIN_S and not any(self._samples.values()):
            types = ", ".join(f"{one:02d}" for one in sorted(self._types))
            raise InvalidInput(
                f"Xsens: MVN sends types {types} and no orientations of this person; switch on 'Position + Orientation "
                "(Quaternion)' in MVN's network streamer, or name the person with --character"
            )
        return None

    def read(self, timeout_s: float) -> SourceFrame | None:
        """The next frame, as soon as the one after it has come."""
        assert self._described is not None and self._differences is not None, "connect first"
        if not self.receiving:
            self._datagrams.drop_waiting()
            self.receiving = True
        until = time.perf_counter() + timeout_s
        while not self._ready:
            one = self._datagrams.take(max(0.0, until - time.perf_counter()))
            found = None if one is None else self._read(one)
            if found is not None and found[0] == self._described.kind:
                frame = self._oriented(found[1], self._described)
                self._ready.extend(map(self._frame, self._differences.put(frame)))
            if not self._ready:  # also where a count stands still and each frame comes late
                self._ready.extend(map(self._frame, self._differences.due(time.perf_counter())))
            if not self._ready and (one is None or time.perf_counter() > until):
                return None
        return self._ready.popleft()

    def news(self) -> list[tuple[str, str]]:
        """Events of the stream since the last call."""
        lost = sum(one.given_up for one in self._joiners.values())
        if lost:
            self._datagrams.report("parts", "samples of which a part never came are left out")
        return self._datagrams.news()

    def close(self) -> None:
        """Listens no more."""
        self._datagrams.close()

    def _read(self, one: Datagram) -> tuple[int, MvnSample] | None:
        """Type and sample that a datagram completes; others are left out, with a report."""
        try:
            found = read_datagram(one.data)
            self._datagrams.heard(one)
            self._types.add(found.kind)
            self._latest_ms = found.time_ms
            if found.kind not in WIDTHS or not self._ours(found):
                return None
            sample = self._joiners[found.kind].put(found, one.arrival_s)
        except InvalidPacket as error:
            self._datagrams.refuse(error)
            return None
        return None if sample is None else (found.kind, sample)

    def _ours(self, one: MvnDatagram) -> bool:
        if self._character is None:
            self._character = one.character
        if one.character == self._character:
            return True
        self._datagrams.report(
            "character", f"person {one.character} of MVN is left out; person {self._character} is followed"
        )
        return False

    def _oriented(self, sample: MvnSample, known: MvnDescription) -> OrientedFrame:
        """The known segments of a sample in metres and world axes."""
        values = np.full((len(known.ids), sample.values.shape[1]), np.nan)
        rows = {int(one): k for k, one in enumerate(sample.ids)}
        for k, one in enumerate(known.ids):
            if one in rows:
                values[k] = sample.values[rows[one]]
        poses = known.kind == POSES
        wxyz = values[:, 3:7] if poses else values[:, :4]
        with np.errstate(all="ignore"):
            turns = multiply(known.turn, unit_quaternions(wxyz[:, [1, 2, 3, 0]]))
            turns = multiply(turns, known.laid) if poses else turns
            vectors = (values[:, :3] * known.metres if poses else values[:, 4:7]) @ known.rotation.T
        places, accelerations = (vectors, None) if poses else (None, vectors)
        imus = np.full((len(known.ids), 6), np.nan)
        return OrientedFrame(
            sample.number // known.step, sample.arrival_s, turns, places, accelerations, imus
        )

    def _frame(self, one: OrientedFrame) -> SourceFrame:
        assert self._described is not None
        turns = one.turns if self._described.kind == POSES else None
        return SourceFrame(
            one.number, one.arrival_s, NO_POINTS, NO_POINTS, PlateSamples.none(0), one.imus, turns
        )
