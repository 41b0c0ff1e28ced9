"""A suit followed live: the person stands, turns round, and joint angles are those of the motion that was played."""

import threading

import numpy as np
import pytest

from benchmarks.streams.xsens_server import XsensServer, suit_of
from mbkf.io.results_folder import read_reconstruction
from mbkf.model.clinical import ClinicalAngles
from mbkf.stream.run.sensor_standing import SensorStanding
from mbkf.stream.run.session import LiveSession
from mbkf.stream.xsens.source import XsensSource
from mbkf.trial.preparation.settings import ReconstructSettings
from tests.worn import RATE_HZ, worn

STOP, FRAMES, STOOD = threading.Event(), 420, 200
FLEXION = [f"{joint}_{side}" for joint in ("hip_flexion", "hip_rotation", "knee_angle") for side in "rl"]


class Kept:
    """A source of frames that were received before."""

    patient = True

    def __init__(self, stream, frames):
        self._stream, self._frames = stream, list(frames)

    def connect(self, timeout_s):
        return self._stream

    def read(self, timeout_s):
        if not self._frames:
            raise EOFError
        return self._frames.pop(0)

    def news(self):
        return []

    def close(self):
        pass


@pytest.fixture(scope="module")
def turn():
    """A person who stands for 2.3 s, and then turns round."""
    return worn("turn", 9.0)


@pytest.fixture(scope="module")
def kept(turn):
    suit = suit_of(turn.model, turn.motion.q[:FRAMES], RATE_HZ)
    source = XsensSource(0, "127.0.0.1")
    server, stream = XsensServer(suit, source.port), None
    for k in range(FRAMES):
        if stream is None:
            server.play(k)
            stream = source.connect(0.0)
    source.receiving = True
    frames = []
    for k in range(FRAMES):
        server.play(k)
        frames.append(source.read(0.0))
    source.close()
    server.close()
    return stream, [one for one in frames if one is not None]


@pytest.mark.parametrize("measured", [True, False])
def test_angles_are_those_of_the_motion(turn, kept, tmp_path, measured):
    posture = turn.motion.q[100] if measured else None
    start = SensorStanding(Kept(*kept), "xsens", turn.model, tmp_path, lambda _: None, posture=posture)
    assert start.connect(STOP, 1.0)
    found = start.find(STOP)
    settings = ReconstructSettings(correct_markers=False, checks=False)
    session = LiveSession(
        found.source, turn.subject, settings, tmp_path, "xsens", found.report, sensors=found.worn
    )
    assert session.connect(STOP, 1.0)
    assert not session.run(STOP).problem
    result = read_reconstruction(tmp_path)
    angles = ClinicalAngles(turn.model)
    columns = [angles.names.index(name) for name in FLEXION]
    first = 1 + STOOD  # the first frame has no neighbour before it
    true = angles.angles(turn.motion.q[first : first + len(result.q)])[:, columns]
    off = np.degrees(angles.angles(result.q)[:, columns] - true)
    assert len(result.q) == FRAMES - 2 - STOOD
    np.testing.assert_array_less(np.sqrt((off**2).mean(axis=0)), 1.0)
