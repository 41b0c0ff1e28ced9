"""Bundles of Open Sound Control are those of its specification."""

import struct

import numpy as np

from mbkf.stream.results.osc import AT_ONCE, OscBundles, message, text
from tests.stream.results.test_websocket import MODEL, shown_frame


def read(bundle):
    """Addresses, types and arguments of a bundle's messages, by the specification."""
    assert bundle[:16] == b"#bundle\0" + AT_ONCE
    found, at = {}, 16
    while at < len(bundle):
        (size,) = struct.unpack_from(">i", bundle, at)
        assert size % 4 == 0
        part = bundle[at + 4 : at + 4 + size]
        address = part.split(b"\0", 1)[0]
        tags = part[len(address) // 4 * 4 + 4 :]
        kind = tags[:2].decode()
        found[address.decode()] = (kind, tags[4:])
        at += 4 + size
    return found


def test_the_specifications_own_message():
    """Its example: /oscillator/4/frequency with 440.0."""
    made = text("/oscillator/4/frequency") + text(",f") + struct.pack(">f", 440.0)
    assert made.hex() == "2f6f7363696c6c61746f722f342f6672657175656e6379002c66000043dc0000"
    assert message("a", ",i", struct.pack(">i", 1)) == b"/mbkf/a\0,i\0\0\0\0\0\1"
    assert (text(""), text("abc"), text("abcd")) == (b"\0" * 4, b"abc\0", b"abcd\0\0\0\0")


def test_known_numbers_stand_under_their_names():
    names = ("knee", "knee_sd", "hip")
    found = read(OscBundles(names).bundle(shown_frame(MODEL, 7), np.array([0.5, 9.0, np.nan])))
    assert found["/mbkf/knee"] == (",f", struct.pack(">f", 0.5))
    assert found["/mbkf/frame"] == (",i", struct.pack(">i", 7))
    assert found["/mbkf/time"] == (",d", struct.pack(">d", 0.07))
    assert {"/mbkf/knee_sd", "/mbkf/hip"} & set(found) == set()
