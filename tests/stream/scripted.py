"""A source that plays what a test wrote down, and the run that follows it."""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mbkf.io.records import Capture
from mbkf.io.results import ARRAYS, Reconstruction
from mbkf.io.results_folder import read_reconstruction
from mbkf.io.subject import Subject
from mbkf.stream.played import played
from mbkf.stream.run.session import LiveOutcome, LiveSession
from mbkf.stream.source import PlateSamples, SourceFrame
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct

SETTINGS = ReconstructSettings(correct_markers=False)


class ScriptedSource:
    """Gives the frames of a list; None is a silence, an exception is raised."""

    patient = True

    def __init__(self, stream, script):
        self.stream, self.script, self.closed = stream, list(script), False

    def connect(self, timeout_s):
        return self.stream

    def read(self, timeout_s):
        if not self.script:
            raise EOFError
        item = self.script.pop(0)
        if isinstance(item, Exception):
            raise item
        return item

    def news(self):
        return []

    def close(self):
        self.closed = True


def frames_of(capture: Capture, unlabelled: bool = False) -> tuple:
    """The stream of a capture and its frames, one each 1/rate from now on."""
    made = played(capture, unlabelled)
    begin, nobody = time.perf_counter(), np.zeros((0, 3))
    frames = []
    for frame in made.frames():
        markers, points = (nobody, frame.markers_m) if unlabelled else (frame.markers_m, nobody)
        arrival = begin + frame.number / made.stream.rate_hz
        frames.append(SourceFrame(frame.number, arrival, markers, points, frame.plates))
    return made.stream, frames


def without_plates(frame: SourceFrame) -> SourceFrame:
    return replace(frame, plates=PlateSamples.none(frame.plates.wrench.shape[1]))


@dataclass
class Collected:
    """A listener that keeps all frames."""

    frames: list
    closed: bool = False

    def take(self, frame):
        self.frames.append(frame)

    def close(self):
        self.closed = True


def follow(
    folder: Path, stream, script, subject: Subject, settings=SETTINGS, sinks=(), record=None, **options
) -> LiveOutcome:
    source = ScriptedSource(stream, script)
    session = LiveSession(source, subject, settings, folder, "script", record=record)
    stop = threading.Event()
    assert session.connect(stop, 1.0)
    return session.run(stop, sinks, **options)


def with_hidden(capture: Capture, frames) -> Capture:
    """The capture without any marker in some frames."""
    positions = np.array(capture.markers.positions_m)
    positions[list(frames)] = np.nan
    return replace(capture, markers=replace(capture.markers, positions_m=positions))


def offline(capture: Capture, subject: Subject, settings=SETTINGS) -> Reconstruction:
    """What `reconstruct` gives with the live run's settings: causally, or with their lag."""
    return reconstruct(capture, subject, settings=replace(settings, smooth=False))


OFFLINE_ONLY = ("trunk_moments_sd", "trunk_moments_sd_offset")
"""Standard deviations that live runs do not state, since they would delay every answer."""


def assert_same(folder: Path, expected: Reconstruction, but=()) -> None:
    """What a run wrote is the reconstruction, to 1e-9 of what is usual for a quantity (numbers of 32 bits: 1e-5)."""
    found = read_reconstruction(folder)
    for name in ARRAYS:
        one, other = getattr(found, name), getattr(expected, name)
        if name in ("step_seconds", "covariance", *OFFLINE_ONLY, *but):
            continue
        assert (one is None) == (other is None), name
        if one is not None:
            limit = 1e-9 if one.dtype != np.float32 else 1e-5
            np.testing.assert_allclose(one, other, rtol=limit, atol=limit, err_msg=name)


def kinds(outcome: LiveOutcome) -> set:
    return {event["kind"] for event in outcome.report["events"]}
