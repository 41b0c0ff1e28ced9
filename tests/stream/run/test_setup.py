"""Preparation of a run before its first frame: the markers of a second person are reported."""

from dataclasses import replace

from mbkf.stream.run.setup import prepare
from tests.captures import made_capture
from tests.stream.scripted import SETTINGS, frames_of


def test_markers_that_a_stream_names_twice_are_reported(subject):
    stream, _ = frames_of(made_capture(2))
    notes = []
    prepare(stream, subject, SETTINGS, True, lambda *one: notes.append(one))
    assert notes == []
    twice = replace(stream, marker_names=(*stream.marker_names, *stream.marker_names[:5], "other", "other"))
    setup = prepare(twice, subject, SETTINGS, True, lambda *one: notes.append(one))
    ((kind, sentence, *_),) = notes
    assert kind == "person" and "5 markers more than once (RASI, LASI, SACR, C7 …)" in sentence
    assert list(setup.columns) == list(range(len(setup.names)))
