"""Frames of standing still: enough of them make a capture; movement or missing markers are the reason to wait."""

from dataclasses import replace

import numpy as np

from mbkf.stream.run.stance import StanceFrames
from tests.captures import made_capture
from tests.stream.scripted import frames_of


def test_a_second_of_standing_makes_a_capture():
    stream, frames = frames_of(made_capture(110, 0.0))
    stance = StanceFrames(stream, None)
    for frame in frames:
        stance.push(frame)
        if stance.enough:
            break
    capture = stance.capture()
    assert (len(stance), stance.progress) == (capture.markers.frames, 1.0)
    assert (stance.first_number, stance.last_number) == (0, len(stance) - 1)
    assert capture.markers.names == stream.marker_names
    assert len(capture.plates[0].force_n) == sum(len(f.plates.index) for f in frames[: len(stance)])
    stance.restart()
    assert len(stance) == 0


def test_movement_and_missing_markers_are_named():
    stream, frames = frames_of(made_capture(5, 0.0))
    stance = StanceFrames(stream, None)
    stance.push(frames[0])
    moved = frames[1].markers_m.copy()
    moved[3, 0] += 0.2
    stance.push(replace(frames[1], markers_m=moved))
    assert stance.hindrance.startswith(f"marker {stream.marker_names[3]} moved 20")
    hidden = np.full_like(moved, np.nan)
    hidden[:6] = moved[:6]
    stance.push(replace(frames[2], markers_m=hidden))
    stance.push(replace(frames[2], markers_m=hidden + 1.0))
    stance.push(replace(frames[2], markers_m=hidden + 1.0))
    assert "markers are seen (not " in stance.hindrance
    assert stance.progress == 0.0
