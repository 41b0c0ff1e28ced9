"""Writing marker protocols as the files that :func:`mbkf.model.protocol.load_protocol` reads."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from mbkf.errors import InvalidInput
from mbkf.io.atomic import remove_file, write_text
from mbkf.io.files_read import read_state
from mbkf.model.protocol import Protocol, ProtocolMarker

_HEADING = (
    "# A marker set, written by mbkf: which markers there are, on which segment, where.",
    "# Positions in m in the segment's frame on the reference body (x forward, y left, z up).",
)


def protocol_text(protocol: Protocol, body: str = "") -> str:
    """A protocol as TOML, from which :func:`mbkf.model.protocol.load_protocol` makes the same protocol.

    A marker is written by its landmark where it sits exactly there, else by its segment and position. Standard
    deviations are in mm; a value that was read from a file is written back exactly.

    Args:
        protocol: The protocol.
        body: Name of its body, or a body file beside the protocol's; by default the body's own name.
    """
    lines = [
        *_HEADING,
        f"name = {_text(protocol.name)}",
        f"title = {_text(protocol.title)}",
        f"body = {_text(body or protocol.body.name)}",
    ]
    if protocol.source:
        lines.append(f"source = {_text(protocol.source)}")
    if not protocol.markers:
        lines.append("marker = []")
    for marker in protocol.markers:
        lines += ["", "[[marker]]", *_marker_lines(marker, protocol)]
    for name, reason in protocol.ignored.items():
        lines += ["", "[[ignored]]", f"name = {_text(name)}", f"reason = {_text(reason)}"]
    return "\n".join(lines) + "\n"


def write_protocol(protocol: Protocol, path: str | Path, *, edits: bool = False) -> None:
    """Writes a protocol, whole or not at all; a user's own body is written beside it, as ``STEM_body.toml``.

    Args:
        protocol: The protocol.
        path: The file, which must end in ``.toml`` to be read again.
        edits: The file is the marker set that was changed, and may be a user's own.

    Raises:
        ProtectedFile: The file was read, or mbkf did not write it.
        InvalidInput: The file does not end in ``.toml``, or the body's file exists and holds another body.
        OSError: It cannot be written.
    """
    target = checked_name(path)
    text = protocol.body.text
    beside = target.with_name(f"{target.stem}_body.toml")
    there = beside.is_file() and read_state(beside) == text
    if text and not there:
        if beside.exists():
            raise InvalidInput(
                f"{beside} exists and holds another body; remove it, or choose another name for the marker set"
            )
        write_text(beside, text)
    try:
        write_text(target, protocol_text(protocol, beside.name if text else ""), edits=edits)
    except BaseException:
        if text and not there:
            remove_file(beside)  # a body without its marker set
        raise


def checked_name(path: str | Path) -> Path:
    """The file, if a marker set can be written to it; commands check this before long work.

    Raises:
        InvalidInput: It does not end in ``.toml``, or is a folder.
    """
    target = Path(path)
    if target.suffix != ".toml":
        raise InvalidInput(f"{target}: a marker set is a TOML file; give a name that ends in .toml")
    if target.is_dir():
        raise InvalidInput(f"{target} is a folder; give a file name that ends in .toml")
    return target


def _marker_lines(marker: ProtocolMarker, protocol: Protocol) -> list[str]:
    landmark = protocol.body.landmarks.get(marker.landmark)
    there = (
        landmark is not None
        and landmark.segment == marker.segment
        and np.array_equal(landmark.position_m, marker.position_m)
    )
    lines = [f"name = {_text(marker.name)}"]
    if there:
        lines.append(f"landmark = {_text(marker.landmark)}")
    else:
        position = ", ".join(repr(float(x)) for x in marker.position_m)
        lines += [f"segment = {_text(marker.segment)}", f"position_m = [{position}]"]
    lines += [
        f"kind = {_text(marker.kind)}",
        f"placement_sd_mm = {_millimetres(marker.placement_sd_m)!r}",
        f"noise_mm = {_millimetres(marker.noise_m)!r}",
    ]
    if marker.kind == "keypoint" or marker.correlated_m:
        lines.append(f"correlated_mm = {_millimetres(marker.correlated_m)!r}")
        lines.append(f"correlation_s = {float(marker.correlation_s)!r}")
    if marker.aliases:
        lines.append(f"aliases = [{', '.join(_text(alias) for alias in marker.aliases)}]")
    if marker.static_only:
        lines.append("static_only = true")
    if marker.probability != 1.0:
        lines.append(f"probability = {float(marker.probability)!r}")
    if marker.alternatives:
        others = ", ".join(f"[{_text(name)}, {float(odds)!r}]" for name, odds in marker.alternatives)
        lines.append(f"alternatives = [{others}]")
    return lines


def _millimetres(metres: float) -> float:
    """The shortest number of millimetres that is read as these metres again, or the nearest there is."""
    near = 1e3 * metres
    tries = [float(f"{near:.{digits}g}") for digits in range(1, 18)]
    tries += [float(np.nextafter(near, side)) for side in (-np.inf, np.inf)]
    return next((one for one in tries if one / 1e3 == metres), near)


def _text(value: str) -> str:
    """A TOML string; surrogates that no file can hold become question marks."""
    whole = value.encode("utf-8", "replace").decode("utf-8")
    return json.dumps(whole, ensure_ascii=False).replace("\x7f", "\\u007f")
