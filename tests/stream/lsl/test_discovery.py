"""Streams of markers in the network are found by name, those of other kinds left out."""

import uuid
from types import SimpleNamespace

from mbkf.stream.libraries import lsl
from mbkf.stream.lsl import discovery
from mbkf.stream.lsl.discovery import marker_streams
from mbkf.stream.lsl.inlets import streams_of

LOOK_S = 2.0


def outlet(name, kind):
    pylsl = lsl()
    return pylsl.StreamOutlet(pylsl.StreamInfo(name, kind, 3, 120.0, "float32", name))


def test_streams_of_markers_are_found_in_the_order_of_their_names(monkeypatch):
    base, asked = f"mbkf-test-{uuid.uuid4().hex[:8]}", []
    kept = [outlet(f"{base}-{k}", kind) for k, kind in (("b", "MoCap"), ("a", "mocap"), ("c", "EEG"))]
    every = lsl().resolve_streams(LOOK_S)  # looked for once, since each look takes its whole time
    library = SimpleNamespace(resolve_streams=lambda seconds: asked.append(seconds) or every)
    monkeypatch.setattr(discovery, "lsl", lambda: library)
    found = [one for one in marker_streams(LOOK_S) if one.name.startswith(base)]
    assert [one.name for one in found] == [f"{base}-a", f"{base}-b"] and asked == [LOOK_S]
    assert all(one.address for one in found) and found[0].options == {"stream": f"{base}-a"}
    assert {one.markers for one in found} == {None}, "they do not say which channels are markers"
    assert f"{base}-c" in [one.name() for one in streams_of(library, ("eeg",), LOOK_S)]
    del kept
