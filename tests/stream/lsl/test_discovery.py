"""Streams of markers in the network are found by name, those of other kinds left out."""

import uuid

from mbkf.stream.libraries import lsl
from mbkf.stream.lsl.discovery import marker_streams, streams_of


def outlet(name, kind):
    pylsl = lsl()
    return pylsl.StreamOutlet(pylsl.StreamInfo(name, kind, 3, 120.0, "float32", name))


def test_streams_of_markers_are_found_in_the_order_of_their_names():
    base = f"mbkf-test-{uuid.uuid4().hex[:8]}"
    kept = [outlet(f"{base}-{k}", kind) for k, kind in (("b", "MoCap"), ("a", "mocap"), ("c", "EEG"))]
    found = [one for one in marker_streams(2.0) if one.name.startswith(base)]
    assert [one.name for one in found] == [f"{base}-a", f"{base}-b"]
    assert {one.rate_hz for one in found} == {120.0} and all(one.host for one in found)
    assert f"{base}-c" in [one.name() for one in streams_of(lsl(), ("eeg",), 2.0)]
    del kept
