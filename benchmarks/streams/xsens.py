"""Rows of the simulated MVN streamer: a made person turns round in the suit, followed by a live run in this process.

The streamer plays a sample whenever the run wants a frame, so that no row depends on the machine: frames lost, angles
against the true motion, and faults of datagrams, each in a run of its own.
"""

from __future__ import annotations

import struct
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, Context, information
from benchmarks.streams.xsens_server import XsensServer, suit_of
from mbkf.conventions import Array, BoolArray
from mbkf.io.results_folder import read_reconstruction
from mbkf.io.subject import Subject
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.stream.run.sensor_standing import SensorStanding
from mbkf.stream.run.session import LiveSession
from mbkf.stream.source import SourceFrame, StreamDescription
from mbkf.stream.xsens.source import XsensSource
from mbkf.synthesis.motion import synthesise_motion
from mbkf.synthesis.person import body_of, synthesise_subject
from mbkf.trial.preparation.settings import ReconstructSettings

SECONDS, STOOD_S, RATES_HZ, SEED = 5.0, 2.5, (100.0, 240.0), 11
FAULT_FRAMES = 400
FIRST_FAULT, PERIOD = 260, 20
"""Faults strike from this sample on, every so many samples."""

ANGLE_DEG = 1.0
ANGLES = tuple(
    f"{name}_{side}" for name in ("hip_flexion", "hip_rotation", "knee_angle", "ankle_angle") for side in "rl"
)

Strike = Callable[[XsensServer, int, np.random.Generator], None]
"""Sends a sample in a way of its own."""


class PlayedSuit:
    """A :class:`mbkf.stream.source.FrameSource` whose streamer plays on whenever a frame is wanted."""

    patient = True

    def __init__(self, server: XsensServer, source: XsensSource, strike: Strike | None, seed: int) -> None:
        """A suit that has not been played yet.

        Args:
            server: The streamer.
            source: The source that hears it.
            strike: A fault; None for none.
            seed: What it is drawn from.
        """
        self._server, self._source, self._strike = server, source, strike
        self._rng, self._next, self._empty = np.random.default_rng(seed), 0, 0

    def connect(self, timeout_s: float) -> StreamDescription | None:
        """The stream, by samples that are played again afterwards."""
        del timeout_s
        found = None
        for k in range(len(self._server.suit)):
            self._server.play(k)
            found = self._source.connect(0.0)
            if found is not None:
                break
        self._source.receiving = True
        return found

    def read(self, timeout_s: float) -> SourceFrame | None:
        """The next frame; each call plays one sample, so that the source always has one to read.

        Raises:
            EOFError: The suit has been played.
        """
        del timeout_s
        k, self._next = self._next, self._next + 1
        if k < len(self._server.suit):
            if self._strike is not None and k >= FIRST_FAULT and k % PERIOD == 0:
                self._strike(self._server, k, self._rng)
            else:
                self._server.play(k)
        found = self._source.read(0.0)
        if found is None and k >= len(self._server.suit):
            raise EOFError
        return found

    def news(self) -> list[tuple[str, str]]:
        """Events of the stream."""
        return self._source.news()

    def close(self) -> None:
        """Ends both sides."""
        self._source.close()
        self._server.close()


@dataclass(frozen=True)
class Followed:
    """A run: live.json, and configurations with their times."""

    report: dict[str, object]
    q: Array
    tracked: BoolArray
    failure: str


def xsens_rows(context: Context) -> Iterator[Check]:
    """Frames lost, angles against the true motion, and faults."""
    subject = synthesise_subject(SEED)
    model = body_of(subject)
    for rate_hz in RATES_HZ:
        q = turning(model, rate_hz)
        found = follow(subject, model, q, rate_hz, context.out / f"xsens-{rate_hz:g}")
        name = f"a person turns round, {rate_hz:g} Hz"
        lost = float(str(found.report["frames_lost"]))
        yield Check(f"{name}: lost of {found.report['frames_in']}", lost, 0.0, "<=", "frames")
        yield Check(
            f"{name}: angles of the legs, worst root mean square",
            worst_deg(model, found.q, q),
            ANGLE_DEG,
            "<=",
            "deg",
        )
    q = turning(model, 100.0)[:FAULT_FRAMES]
    died, wrong, astray = 0, 0, 0
    for k, (name, strike) in enumerate(FAULTS.items()):
        found = follow(subject, model, q, 100.0, context.out / f"xsens-fault-{k}", strike, k)
        counts = [int(str(found.report[f"frames_{key}"])) for key in ACCOUNTS]
        apart = abs(int(str(found.report["frames_in"])) - sum(counts))
        lost_body = not found.tracked[-10:].any()
        died, wrong, astray = died + bool(found.failure), wrong + apart, astray + lost_body
        if found.failure or apart or lost_body:
            yield information(f"{name}: {found.failure or 'not accounted for, or not tracked'}"[:200], 1.0)
    kinds = f"{len(FAULTS)} faults of datagrams"
    yield Check(f"{kinds}: runs that failed", float(died), 0.0, "<=")
    yield Check(f"{kinds}: frames not accounted for", float(wrong), 0.0, "<=")
    yield Check(f"{kinds}: runs not tracked at their end", float(astray), 0.0, "<=")


ACCOUNTS = ("written", "not_written", "unanswered", "late", "overwritten")


def turning(model: HumanModel, rate_hz: float) -> Array:
    """(T, nq) a person who stands still and then turns round."""
    q = synthesise_motion(model, "turn", SECONDS, rate_hz, SEED).q
    return np.vstack([np.repeat(q[:1], round(STOOD_S * rate_hz), axis=0), q])


def worst_deg(model: HumanModel, q: Array, true_q: Array) -> float:
    """Worst root mean square error of the legs' angles.

    Args:
        model: The body.
        q: (n, nq) found configurations, up to the last frame but one, since the last has no neighbour.
        true_q: (T, nq) the motion.
    """
    angles = ClinicalAngles(model)
    columns = [angles.names.index(one) for one in ANGLES]
    true = true_q[len(true_q) - 1 - len(q) : len(true_q) - 1]
    off = np.degrees(angles.angles(q)[:, columns] - angles.angles(true)[:, columns])
    return float(np.sqrt((off**2).mean(axis=0)).max())


def follow(
    subject: Subject,
    model: HumanModel,
    q: Array,
    rate_hz: float,
    folder: Path,
    strike: Strike | None = None,
    seed: int = 0,
) -> Followed:
    """Follows a motion that begins with standing still.

    Args:
        subject: The person.
        model: Its body.
        q: (T, nq) the motion.
        rate_hz: Its rate.
        folder: For the results.
        strike: A fault; None for none.
        seed: What it is drawn from.
    """
    folder.mkdir(parents=True, exist_ok=True)
    source, stop = XsensSource(0, "127.0.0.1"), threading.Event()
    played = PlayedSuit(XsensServer(suit_of(model, q, rate_hz), source.port), source, strike, seed)
    start = SensorStanding(played, "xsens", model, folder, lambda _: None)
    start.connect(stop, None)
    found = start.find(stop)
    assert found is not None
    settings = ReconstructSettings(correct_markers=False, checks=False)
    session = LiveSession(found.source, subject, settings, folder, "xsens", found.report, sensors=found.worn)
    session.connect(stop, None)
    outcome = session.run(stop)
    result = read_reconstruction(folder)
    return Followed(outcome.report, result.q, result.tracked, outcome.failure or outcome.problem or "")


def _again(server: XsensServer, k: int, rng: np.random.Generator) -> None:
    del rng
    server.play(k)
    server.play(k)


def _swapped(server: XsensServer, k: int, rng: np.random.Generator) -> None:
    del rng
    server.play(k + 1)
    server.play(k)


def _changed(alter: Callable[[bytes, np.random.Generator], bytes]) -> Strike:
    """A fault that alters the sample's datagram; the sample itself does not come."""

    def strike(server: XsensServer, k: int, rng: np.random.Generator) -> None:
        server.send(alter(server.sample(k, 2, k)[0], rng))

    return strike


def _beside(kind: int) -> Strike:
    """Data of another type comes before the sample."""

    def strike(server: XsensServer, k: int, rng: np.random.Generator) -> None:
        del rng
        server.play(k, (kind, 2))

    return strike


def _in_parts(lose: bool) -> Strike:
    def strike(server: XsensServer, k: int, rng: np.random.Generator) -> None:
        parts = server.sample(k, 2, k, most=200)
        if lose:
            parts.pop(int(rng.integers(len(parts))))
        for at in rng.permutation(len(parts)):
            server.send(parts[at])

    return strike


def _other_person(server: XsensServer, k: int, rng: np.random.Generator) -> None:
    del rng
    data = bytearray(server.sample(max(0, k - 100), 2, k)[0])
    data[16] = 1
    server.send(bytes(data))
    server.play(k)


FAULTS: dict[str, Strike] = {
    "lost samples": lambda *_: None,
    "samples twice": _again,
    "samples swapped": _swapped,
    "half datagrams": _changed(lambda data, rng: data[: int(rng.integers(1, len(data)))]),
    "datagrams of garbage": _changed(lambda _, rng: rng.bytes(int(rng.integers(1, 1400)))),
    "payloads of garbage": _changed(lambda data, rng: data[:24] + rng.bytes(len(data) - 24)),
    "a count of 255 items": _changed(lambda data, _: data[:11] + b"\xff" + data[12:]),
    "another size stated": _changed(lambda data, _: data[:22] + struct.pack(">H", 65535) + data[24:]),
    "quaternions that are none": _changed(
        lambda data, _: data[:24] + b"\x7f\xc0\x00\x00" * ((len(data) - 24) // 4)
    ),
    "a count far ahead": _changed(lambda data, _: data[:6] + struct.pack(">I", 2**32 - 5) + data[10:]),
    "a count that begins anew": _changed(lambda data, _: data[:6] + struct.pack(">I", 3) + data[10:]),
    "samples in parts, in any order": _in_parts(lose=False),
    "a part never comes": _in_parts(lose=True),
    "joint angles beside": _beside(20),
    "trackers beside": _beside(23),
    "time codes beside": _beside(25),
    "another person's samples": _other_person,
}
"""Faults by name."""
