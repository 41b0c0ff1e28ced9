"""All protocols are searched at once."""

import threading

import pytest

from mbkf.errors import MissingDependency
from mbkf.stream import discovery
from mbkf.stream.discovery import find_streams


def test_all_protocols_are_searched_at_once_and_a_missing_library_is_stated(monkeypatch):
    together = threading.Barrier(2)

    def lsl(local, timeout_s, place):
        together.wait(30.0)
        raise MissingDependency("pylsl", "Lab Streaming Layer", "lsl")

    def udp(local, timeout_s, place):
        together.wait(30.0)
        return [(local, timeout_s, place)]

    monkeypatch.setattr(discovery, "SEARCHES", {"lsl": lsl, "udp": udp})
    found = find_streams(("lsl", "udp:15200"), "0.0.0.0", 0.5)
    assert found.streams == (("0.0.0.0", 0.5, "15200"),)
    assert len(found.not_searched) == 1 and found.not_searched[0].startswith("lsl: not searched (")


@pytest.mark.parametrize(
    ("kind", "module", "name", "given"),
    [
        ("vicon", "vicon", "vicon_streams", (0.5, "127.0.0.1", 801)),
        ("vicon:lab:802", "vicon", "vicon_streams", (0.5, "lab", 802)),
        ("qualisys", "qualisys", "qualisys_streams", ("here", 0.5)),
        ("qualisys:lab", "qualisys", "qualisys_at", ("lab", 22222)),
        ("xsens", "xsens", "xsens_streams", ("here", 0.5, 9763)),
        ("xsens:9764", "xsens", "xsens_streams", ("here", 0.5, 9764)),
        ("udp:15200", "udp", "udp_streams", ("here", 0.5, 15200)),
    ],
)
def test_places_are_given_to_their_protocol(monkeypatch, kind, module, name, given):
    monkeypatch.setattr(f"mbkf.stream.{module}.discovery.{name}", lambda *words: [words])
    assert find_streams((kind,), "here", 0.5).streams == (given,)


@pytest.mark.parametrize("port", ["0", "65536", "x", "9" * 5000, "²"])
def test_a_place_that_is_no_port_is_stated(port):
    (sentence,) = find_streams((f"xsens:{port}",)).not_searched
    assert sentence.startswith(f"xsens:{port}: not searched ('") and "' is not a port" in sentence
