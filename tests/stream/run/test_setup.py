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
    own = stream.marker_names
    few = replace(stream, marker_names=(*own, *own[:5], "other", "other"))
    prepare(few, subject, SETTINGS, True, lambda *one: notes.append(one))
    assert notes == []
    for theirs in (own[:6], [f"B:{name}" for name in own[:6]], [f"{name}_2" for name in own[:6]]):
        notes.clear()
        both = replace(stream, marker_names=(*own, *theirs))
        setup = prepare(both, subject, SETTINGS, True, lambda *one: notes.append(one))
        ((kind, sentence, *_),) = notes
        assert kind == "person" and "6 markers more than once (RASI, LASI, SACR, C7 …)" in sentence
        assert list(setup.columns) == list(range(len(setup.names)))
