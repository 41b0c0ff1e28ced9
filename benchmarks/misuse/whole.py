"""Tells whether a file that mbkf wrote is whole, by its format."""

from __future__ import annotations

import csv
import json
import tomllib
import xml.etree.ElementTree as ET
from collections.abc import Callable, Mapping
from pathlib import Path

import h5py
import pyarrow as pa
import pyarrow.parquet as pq

from benchmarks.misuse.leftovers import leftovers
from mbkf.errors import MbkfError
from mbkf.io.capture import read_capture
from mbkf.io.storage import read_storage

TRC_HEADER_LINES = 6

SIGNATURES = {".png": b"\x89PNG", ".gif": b"GIF8", ".mp4": b"\x00\x00\x00"}


def torn_files(folder: Path) -> list[str]:
    """Files below a folder that are not whole, each with the reason; those under names of unfinished ones left out."""
    unfinished = {folder / name for name in leftovers(folder)}
    found = [folder] if folder.is_file() else [path for path in folder.rglob("*") if path.is_file()]
    found = [path for path in found if unfinished.isdisjoint((path, *path.parents))]
    return [f"{path.name}: {reason}" for path in sorted(found) if (reason := torn(path))]


def torn(path: Path) -> str:
    """The reason why a file is not whole; "" where it is."""
    try:
        if path.suffix in SIGNATURES:
            return "" if path.read_bytes().startswith(SIGNATURES[path.suffix][:3]) else "another signature"
        READERS.get(path.suffix, Path.read_bytes)(path)
    except (MbkfError, OSError, ValueError, SyntaxError, AssertionError) as error:
        return " ".join(str(error).split()) or type(error).__name__
    return ""


def _table(path: Path) -> None:
    text = path.read_text("utf-8")
    assert text.endswith("\n"), "the last line has no end"
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    assert len({len(row) for row in csv.reader(lines)}) == 1, "rows of other lengths"


def _trc(path: Path) -> None:
    """A result of inertial sensors alone has frames without markers, which no capture has."""
    lines = path.read_text("utf-8").splitlines()
    header = lines[2].split("\t") if len(lines) > 2 else []
    if len(header) > 3 and header[3] == "0":
        assert len(lines) == TRC_HEADER_LINES + int(header[2]), "frames missing"
    else:
        read_capture(path)


def _parquet(path: Path) -> None:
    """Arrow takes no path whose bytes are not UTF-8."""
    pq.read_table(pa.BufferReader(path.read_bytes()))


def _page(path: Path) -> None:
    assert path.read_text("utf-8").rstrip().endswith("</html>"), "the page has no end"


def _motion(path: Path) -> None:
    with h5py.File(path) as file:
        assert len(file), "nothing in it"


def _glb(path: Path) -> None:
    content = path.read_bytes()
    assert int.from_bytes(content[8:12], "little") == len(content), "another length than its header's"


def _bvh(path: Path) -> None:
    lines = path.read_text("utf-8").splitlines()
    at = next(k for k, line in enumerate(lines) if line.startswith("Frames:"))
    assert len(lines) - at - 2 == int(lines[at].split()[1]), "frames missing"


READERS: Mapping[str, Callable[[Path], object]] = {
    ".toml": lambda path: tomllib.loads(path.read_text("utf-8")),
    ".json": lambda path: json.loads(path.read_text("utf-8")),
    ".c3d": read_capture, ".trc": _trc, ".mot": read_storage, ".sto": read_storage, ".h5": _motion,
    ".parquet": _parquet, ".csv": _table, ".html": _page, ".xml": ET.parse, ".urdf": ET.parse, ".glb": _glb,
    ".bvh": _bvh,
}  # fmt: skip
