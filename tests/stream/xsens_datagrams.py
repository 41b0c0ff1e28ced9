"""MVN's datagrams for tests, by hand from the specification: header of 24 bytes, items, big endian."""

import struct

PELVIS_HEAD = {1: (0.0, 0.0, 0.9), 7: (0.0, 0.0, 1.5)}
STRAIGHT = (1.0, 0.0, 0.0, 0.0)


def datagram(number=0, *, kind=2, counter=0x80, character=0, time_ms=None, items=(), size=None):
    """A datagram of items, each bytes."""
    body = b"".join(items)
    clock = 10 * number if time_ms is None else time_ms
    return (
        b"MXTP%02d" % kind
        + struct.pack(">IBBI", number, counter, len(items), clock)
        + bytes([character, 23, 0, 0, 0, 0])
        + struct.pack(">H", len(body) if size is None else size)
        + body
    )


def pose(segment, place=(0.0, 0.0, 1.0), turn=STRAIGHT):
    """An item of type 02."""
    return struct.pack(">I7f", segment, *place, *turn)


def tracker(segment, turn=STRAIGHT, free=(0.0, 0.0, 0.0), more=(0.1, 0.2, 0.3)):
    """An item of type 23."""
    return struct.pack(f">I7f{len(more)}f", segment, *turn, *free, *more)


def upright(number, turn=STRAIGHT, places=None, **fields):
    """A pose of pelvis and head."""
    chosen = PELVIS_HEAD if places is None else places
    return datagram(number, items=[pose(one, place, turn) for one, place in chosen.items()], **fields)
