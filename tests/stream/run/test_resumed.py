"""What was read before is read first, then the source goes on."""

import pytest

from mbkf.stream.run.resumed import ResumedSource
from tests.stream.scripted import ScriptedSource, frames_of


def test_frames_that_were_kept_come_first_and_nothing_is_connected_anew(capture):
    stream, frames = frames_of(capture)
    source = ScriptedSource(stream, frames[5:8])
    source.connect = None
    source.news = lambda: [("markers", "gone")]
    resumed = ResumedSource(source, stream, frames[3:5])
    assert resumed.connect(0.0) is stream
    assert resumed.patient
    assert [resumed.read(0.0).number for _ in range(5)] == [3, 4, 5, 6, 7]
    with pytest.raises(EOFError):
        resumed.read(0.0)
    assert resumed.news() == [("markers", "gone")]
    resumed.close()
    assert source.closed
