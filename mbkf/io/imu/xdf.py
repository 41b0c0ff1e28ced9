"""Recordings of Lab Streaming Layer (.xdf), read with the library pyxdf: streams of inertial sensors on one clock."""

from __future__ import annotations

import gzip
import io
import logging
import struct
import zlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from mbkf.errors import FileFormatError, InvalidInput, UnknownName
from mbkf.io.files_read import check_input, read_bytes
from mbkf.io.imu.channels import Channel, channel_signals
from mbkf.io.imu.column_names import parse_column_name
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.imu.signals import Signal, readings_of

_DAMAGED = (
    ArithmeticError, AttributeError, EOFError, IndexError, KeyError, LookupError, MemoryError, OSError, TypeError,
    ValueError, struct.error, zlib.error, SyntaxError,
)  # fmt: skip
"""Errors that pyxdf raises of damaged files; XML's error is a SyntaxError."""

_FRAME = "orientation in the world of the maker's filter, z up"


def read_xdf(path: Path, units: Mapping[str, str] | None = None) -> tuple[ImuReadings, ...]:
    """The sensors of a recording; one whose channels do not name it has the name of its stream.

    ``units`` are those that channels do not state.

    Raises:
        FileFormatError: The file is missing or damaged, or holds no sensor's stream.
        InvalidInput: A unit is stated nowhere.
        UnknownName: Unknown unit.
    """
    check_input(path, "name a recording of Lab Streaming Layer (.xdf)")
    signals = list[Signal]()
    try:
        for stream in _streams(path):
            signals += _signals(path, stream, units)
        return readings_of(path, signals, frame=_FRAME)
    except (InvalidInput, UnknownName, FileFormatError):
        raise
    except _DAMAGED as error:
        raise FileFormatError(path, f"damaged, or no XDF file ({error}); record or copy it again") from error


def _streams(path: Path) -> Sequence[dict[str, Any]]:
    """The streams that pyxdf finds; an error in its log, as where chunks are cut, is an error here."""
    import pyxdf

    content = read_bytes(path)
    if path.suffix.lower() == ".xdfz":
        content = gzip.decompress(content)
    with _errors_of("pyxdf.pyxdf") as errors, np.errstate(all="ignore"):
        streams, _ = pyxdf.load_xdf(io.BytesIO(content))
    if errors:
        raise FileFormatError(path, f"damaged or cut short ({errors[0]}); record or copy it again")
    return list(streams)


@contextmanager
def _errors_of(name: str) -> Iterator[list[str]]:
    """Errors that a logger reports, in place of its own output."""
    errors = list[str]()

    class Listener(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            if record.levelno >= logging.ERROR:
                errors.append(record.getMessage())

    logger, listener = logging.getLogger(name), Listener()
    passed_on, logger.propagate = logger.propagate, False
    logger.addHandler(listener)
    try:
        yield errors
    finally:
        logger.removeHandler(listener)
        logger.propagate = passed_on


def _signals(path: Path, stream: dict[str, Any], units: Mapping[str, str] | None) -> list[Signal]:
    """Signals of one stream; none where it is another kind of stream."""
    info = stream["info"]
    series = stream["time_series"]
    if not isinstance(series, np.ndarray) or series.ndim != 2 or len(series) < 2:
        return []
    name, kind = _first(info, "name"), _first(info, "type")
    described = _channels(info)
    if len(described) != series.shape[1]:
        described = [(f"{kind} {axis}", "") for axis in "xyz"] if series.shape[1] == 3 else []
    bare = parse_column_name(f"{kind} x") or parse_column_name(f"{name} x")
    channels = [
        Channel(label, unit, np.asarray(series[:, k], dtype=np.float64))
        for k, (label, unit) in enumerate(described)
    ]
    return channel_signals(
        path,
        channels,
        np.asarray(stream["time_stamps"], dtype=np.float64),
        units=units,
        sensor=name,
        kind="" if bare is None else bare.kind,
    )


def _channels(info: dict[str, Any]) -> list[tuple[str, str]]:
    """Label and unit of every channel, as the stream describes them."""
    described = (info.get("desc") or [None])[0] or {}
    groups = (described.get("channels") or [None])[0] or {}
    return [(_first(one, "label"), _first(one, "unit")) for one in groups.get("channel") or []]


def _first(info: dict[str, Any], key: str) -> str:
    value = (info.get(key) or [""])[0]
    return value if isinstance(value, str) else ""
