"""Odd C3D files are read as the sound capture that they were made of, or refused for the stated reason.

Each of :mod:`benchmarks.strangers.odd_c3d_kinds` is written, read and compared sample for sample; three processors'
encodings of one trial are compared with each other.
"""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from benchmarks.checks import Check
from benchmarks.strangers.c3d_parts import C3dParts
from benchmarks.strangers.odd_c3d_kinds import ODD, WHOLE, OddC3d
from mbkf.conventions import Array
from mbkf.errors import MbkfError
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture

LEAST_READ = 100.0 * 32 / 35
"""Share of the kinds that is read and not refused, %: 32 of 35 odd files that were found in public."""

ENCODINGS = ("pr", "vi", "vr", "si", "sr")
"""Processor and number format of the encodings of one trial: Intel, DEC (VAX), SGI-MIPS; integers, reals."""

SAME_MM = 0.001
"""Rounding of 32-bit floats."""

Answer = tuple[str, str]
"""Outcome ("read", "refused", "wrong") and its explanation."""


def odd_c3d_rows(data: Path) -> list[Check]:
    """Rows of odd files made of shared captures, and of the encodings of one trial.

    Args:
        data: Folder of the public captures.
    """
    answers = odd_c3d_answers(data)
    count = Counter(outcome for outcome, _ in answers.values())
    read = 100.0 * count["read"] / len(answers)
    return [
        Check(
            f"{len(answers)} odd C3D, read sample for sample, the rest reported", read, LEAST_READ, ">=", "%"
        ),
        Check("odd C3D, neither read so nor refused for the stated reason", count["wrong"], 0, "<="),
        Check("encodings of one trial, largest difference", _encodings_mm(data), SAME_MM, "<=", "mm"),
    ]


def odd_c3d_answers(data: Path) -> dict[str, Answer]:
    """Outcome of each kind by its name, with an explanation of wrong ones.

    Args:
        data: Folder of the public captures.
    """
    sound = {base: read_capture(data / base) for base in sorted({one.base for one in ODD})}
    with TemporaryDirectory() as folder:
        return {one.name: _answer(one, data, sound[one.base], Path(folder) / "odd.c3d") for one in ODD}


def _answer(kind: OddC3d, data: Path, sound: Capture, path: Path) -> Answer:
    parts = C3dParts.of((data / kind.base).read_bytes())
    content = kind.edit(parts)
    path.write_bytes(parts.encoded() if content is None else content)
    try:
        found = read_capture(path)
    except MbkfError as error:
        right = kind.refused and kind.refused in str(error)
        return ("refused", "") if right else ("wrong", f"refused: {error}")
    faults = ["read"] if kind.refused else _differences(kind, found, sound)
    return ("wrong", ", ".join(faults)) if faults else ("read", "")


def _differences(kind: OddC3d, found: Capture, sound: Capture) -> list[str]:
    """Parts of a capture that differ from the sound one, but for those that the kind takes away; a missing remark."""
    one, other = found.markers, sound.markers
    same = {
        "points": _same(one.positions_m, other.positions_m),
        "rates": (one.rate_hz, one.start_time_s) == (other.rate_hz, other.start_time_s),
        "names": one.names == other.names or not kind.named,
        "channels": _same(_channels(found), _channels(sound)),
        "plates": _same(_forces(found), _forces(sound)) if kind.plates else not found.plates,
        "events": found.events == sound.events or not kind.events,
        f"no remark '{kind.says}'": not kind.says or any(kind.says in note for note in found.notes),
    }
    return [name for name, right in same.items() if not right]


def _channels(capture: Capture) -> Array:
    """(C, S) analog samples."""
    return np.array([channel.values for channel in capture.analog])


def _forces(capture: Capture) -> Array:
    """(P, S, 6) forces and moments of the plates."""
    return np.array([np.hstack([plate.force_n, plate.moment_nm]) for plate in capture.plates])


def _same(one: Array, other: Array) -> bool:
    return one.shape == other.shape and np.array_equal(one, other, equal_nan=True)


def _encodings_mm(data: Path) -> float:
    """Largest difference of the encodings' points from the first one's, mm."""
    first = read_capture(data / WHOLE).markers.positions_m
    others = [read_capture(data / WHOLE.replace("pi.c3d", f"{name}.c3d")) for name in ENCODINGS]
    return 1e3 * max(float(np.nanmax(np.abs(one.markers.positions_m - first))) for one in others)
