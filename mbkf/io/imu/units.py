"""Units of inertial quantities, in the spellings that files have."""

from __future__ import annotations

import re

import numpy as np

from mbkf.conventions import GRAVITY_M_S2
from mbkf.errors import UnknownName

UNITS: dict[str, dict[str, float]] = {
    "acc": {"m/s2": 1.0, "g": GRAVITY_M_S2, "mg": 1e-3 * GRAVITY_M_S2},
    "gyr": {"rad/s": 1.0, "deg/s": np.pi / 180.0, "mdeg/s": 1e-3 * np.pi / 180.0},
    "mag": {"ut": 1.0, "nt": 1e-3, "t": 1e6, "gauss": 100.0, "mgauss": 0.1, "au": 1.0},
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9},
}
"""Units of each quantity and their factor to m/s², rad/s, µT and s; "au" is a field of unknown size."""

_SPELLINGS = {
    "m/s/s": "m/s2", "ms2": "m/s2", "ms-2": "m/s2", "mps2": "m/s2", "meter/s2": "m/s2", "meters/s2": "m/s2",
    "m/sec2": "m/s2", "grav": "g", "gs": "g", "milli-g": "mg", "millig": "mg", "rads-1": "rad/s",
    "degs-1": "deg/s", "rad/sec": "rad/s", "deg/sec": "deg/s", "degrees/s": "deg/s", "degree/s": "deg/s",
    "degrees/sec": "deg/s", "radians/s": "rad/s", "radian/s": "rad/s", "rads": "rad/s", "radps": "rad/s",
    "rps": "rad/s", "degs": "deg/s", "dps": "deg/s", "degps": "deg/s", "degpers": "deg/s", "mdps": "mdeg/s",
    "a.u.": "au", "a.u": "au", "arbitrary": "au", "normalized": "au", "normalised": "au", "localflux": "au",
    "microtesla": "ut", "nanotesla": "nt", "tesla": "t", "gs.": "gauss", "mgs": "mgauss", "sec": "s",
    "second": "s", "seconds": "s", "secs": "s", "msec": "ms", "msecs": "ms", "millisecond": "ms",
    "milliseconds": "ms", "usec": "us", "microsecond": "us", "microseconds": "us", "nsec": "ns",
    "nanosecond": "ns", "nanoseconds": "ns",
}  # fmt: skip


def unit_name(kind: str, text: str, where: str) -> str:
    """The unit of :data:`UNITS` that a text means, in any of its spellings.

    Args:
        kind: Quantity, a key of :data:`UNITS`.
        text: The unit as written.
        where: Where it stands, for the message.

    Raises:
        UnknownName: The quantity or unit does not exist.
    """
    if kind not in UNITS:
        raise UnknownName("quantity", kind, UNITS, where)
    plain = plain_unit(kind, text)
    if plain is None:
        raise UnknownName(f"unit of {kind}", text, UNITS[kind], where)
    return plain


def plain_unit(kind: str, text: str) -> str | None:
    """As :func:`unit_name`, or None where the text is not a unit of the quantity."""
    plain = text.strip().lower().replace("µ", "u").replace("μ", "u").replace("²", "2").replace("°", "deg")
    plain = re.sub(r"[\s_^*·()\[\]]", "", plain)
    if kind == "mag" and plain in ("g", "gs"):
        plain = "gauss"
    elif kind == "mag" and plain in ("mg", "mga"):
        plain = "mgauss"
    plain = _SPELLINGS.get(plain, plain)
    return plain if plain in UNITS[kind] else None
