"""All protocols are searched at once."""

import threading

from mbkf.errors import MissingDependency
from mbkf.stream import discovery
from mbkf.stream.discovery import find_streams


def test_all_protocols_are_searched_at_once_and_a_missing_library_is_stated(monkeypatch):
    together = threading.Barrier(2)

    def lsl(local, timeout_s):
        together.wait(30.0)
        raise MissingDependency("pylsl", "Lab Streaming Layer", "lsl")

    def udp(local, timeout_s):
        together.wait(30.0)
        return [(local, timeout_s)]

    monkeypatch.setattr(discovery, "SEARCHES", {"lsl": lsl, "udp": udp})
    found = find_streams(("lsl", "udp"), "0.0.0.0", 0.5)
    assert found.streams == (("0.0.0.0", 0.5),)
    assert len(found.not_searched) == 1 and found.not_searched[0].startswith("lsl: not searched (")
