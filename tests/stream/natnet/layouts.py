"""NatNet messages of protocols 3.0 to 4.1 with everything in them, packed field by field for tests."""

import struct

import numpy as np

from mbkf.stream.natnet import packets

VERSIONS = ((3, 0), (3, 1), (4, 0), (4, 1), (4, 2))


def text(value):
    return value.encode() + b"\0"


def floats(values):
    return np.asarray(values, dtype="<f4").tobytes()


def integers(*values):
    return struct.pack(f"<{len(values)}I", *values)


def part(version, things):
    """Things after their number, and from 4.1 on the size of them all."""
    body = b"".join(things)
    size = integers(len(body)) if version >= (4, 1) else b""
    return integers(len(things)) + size + body


def body():
    """A rigid body of a frame: number, position, orientation, error, flags."""
    return integers(7) + floats(np.arange(8)) + struct.pack("<H", 1)


def channels(number, samples):
    """A plate's or device's samples, one row per channel."""
    return integers(number, len(samples)) + b"".join(integers(len(row)) + floats(row) for row in samples)


def labelled(identity, position, flags, residual=0.5):
    sized = integers(identity) + floats(position) + floats([0.014])
    return sized + struct.pack("<H", flags) + floats([residual])


def frame(version, number=5, time_s=0.5, sets=(), points=(), markers=(), plates=()):
    """A frame with two rigid bodies, two skeletons, an asset and two devices besides what is asked for.

    Sets are pairs of a name and positions, markers are tuples as :func:`labelled` takes them, plates are pairs of a
    number and channels.
    """
    skeleton = integers(3, 2) + body() + body()
    asset = integers(9, 1) + body() + integers(1) + labelled(1, np.ones(3), 2)
    parts = [
        integers(number),
        part(version, [text(name) + integers(len(at)) + floats(at) for name, at in sets]),
        part(version, [floats(point) for point in points]),
        part(version, [body(), body()]),
        part(version, [skeleton, integers(4, 0)]),
        part(version, [asset]) if version >= (4, 1) else b"",
        part(version, [labelled(*marker) for marker in markers]),
        part(version, [channels(*plate) for plate in plates]),
        part(version, [channels(1, [[1.0, 2.0], [3.0]]), channels(2, [])]),
        struct.pack("<2Id3Q", 1, 2, time_s, 3, 4, 5),
        integers(0, 0) if version >= (4, 1) else b"",  # precision time stamp
        struct.pack("<HI", 1, 0),  # parameters, end of data
    ]
    return packets.message(packets.FRAME, b"".join(parts))


def described_body(version):
    """A rigid body of a description, with two markers."""
    turned = floats([0, 0, 0, 1]) if version >= (4, 2) else b""
    names = text("a") + text("b") if version >= (4, 0) else b""
    return text("bone") + integers(1, 0) + floats(np.ones(3)) + turned + integers(2) + bytes(32) + names


def described_plate(number, serial, corners, names=packets.CHANNELS, raw=0):
    fields = integers(number) + text(serial) + floats([0.4, 0.6]) + floats([0.01, 0.02, 0.03])
    calibration = floats(np.arange(144.0))
    return fields + calibration + floats(corners) + integers(2, raw, len(names)) + b"".join(map(text, names))


def descriptions(version, sets, plates, unknown=False):
    """Descriptions of marker sets and plates, with every other kind among them.

    Sets are pairs of a name and names of markers, plates are made by :func:`described_plate`. Something of unknown kind
    may stand in front.
    """
    skeleton = text("person") + integers(1, 2) + 2 * described_body(version)
    device = integers(1) + text("amplifier") + text("s1") + integers(0, 0, 2) + text("one") + text("two")
    camera = text("left") + floats(np.arange(7))
    marker = text("m") + integers(1) + floats(np.ones(4)) + struct.pack("<H", 0)
    asset = text("asset") + integers(1, 2, 1) + described_body(version) + integers(1) + marker
    things = [(17, b"whatever")] if unknown else []
    things += [(1, described_body(version)), (2, skeleton)]
    things += [(0, text(name) + integers(len(names)) + b"".join(map(text, names))) for name, names in sets]
    things += [(4, device), (5, camera)] + ([(6, asset)] if version >= (4, 1) else [])
    things += [(3, plate) for plate in plates]
    packed = [
        integers(kind) + (integers(len(thing)) if version >= (4, 1) else b"") + thing
        for kind, thing in things
    ]
    return packets.message(packets.DESCRIPTIONS, integers(len(things)) + b"".join(packed))


def answer(version, name="Motive"):
    """A server's answer."""
    return packets.message(
        packets.SERVER_INFO, name.encode().ljust(256, b"\0") + bytes([3, 1, 0, 0, *version, 0, 0])
    )


def cut(packet, length):
    """A packet whose payload ends early and that states so."""
    return struct.pack("<HH", struct.unpack_from("<H", packet)[0], length - 4) + packet[4:length]
