"""Ground reactions in Cortex's ``.forces`` files: per plate force, point of application and free moment.

Four lines name the content, the plates, the rate and the samples; a line of names follows (#Sample FX1 FY1 FZ1 X1 Y1
Z1 MZ1 FX2 …), then a row per sample. Forces are those on the body in the laboratory's axes. MZ is the free moment
about the vertical, whichever axis of the laboratory that is. Lengths are those of the calibration, mostly mm, and the
moment is N times that length.

Source: files of the Laboratory of Biomechanics and Motor Control and its notebook read_mac_ascii_files
(github.com/BMClab/BMC).
"""

from __future__ import annotations

from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.force_table import ForceTable, plates_of_table
from mbkf.io.records import PlateReadings
from mbkf.io.text import TextFile, blank_separated, check_order, compare_count, number, read_text

_MOST_HEADER_LINES = 20


def read_forces_cortex(path: str | Path, options: CaptureOptions) -> tuple[PlateReadings, ...]:
    """Ground reactions of a ``.forces`` file, one set per plate; sample 1 is at 0 s.

    Without an axis in the options, the one that carries the weight points up, else y, as in the TRC files beside it.

    Raises:
        FileFormatError: The file is missing, not of that kind, cut short, or columns of a plate are missing.
        InvalidInput: A force, point or moment is not a number.
    """
    file = read_text(Path(path), "a .forces file")
    header, start = _header(file)
    names = file.lines[start].lstrip("#").split()
    values = blank_separated(file.lines, file.path, start + 1, len(names))
    options.notes.extend(compare_count(file, _count(header, "numberofsamples"), len(values), "samples"))
    rate_hz = number(header.get("samplerate", ""))
    if rate_hz is None or not rate_hz > 0.0:
        raise FileFormatError(file.path, "the header gives no SampleRate; write SampleRate=… into it")
    check_order(file.path, values[:, 0], "the number of the sample")
    table = ForceTable(
        str(path), tuple(names[1:]), values[:, 1:], rate_hz, (values[0, 0] - 1.0) / rate_hz, None, None, False
    )
    plates = plates_of_table(table, options)
    promised = _count(header, "numberofforceplates")
    if promised is not None and promised != len(plates):
        options.notes.append(f"the header counts {promised} force plates, {len(plates)} have columns")
    return plates


def _header(file: TextFile) -> tuple[dict[str, str], int]:
    """Entries by their lower-case name, and the index of the line of names."""
    header: dict[str, str] = {}
    if not file.lines or "force data" not in file.lines[0].lower():
        raise FileFormatError(file.path, "not a .forces file (it does not begin with [Force Data])", 1)
    for index, text in enumerate(file.lines[:_MOST_HEADER_LINES]):
        if text.lstrip().lower().startswith("#sample"):
            return header, index
        name, _, value = text.partition("=")
        header[name.strip().lower()] = value.strip()
    raise FileFormatError(file.path, "no line of column names (#Sample FX1 …); export it again")


def _count(header: dict[str, str], name: str) -> int | None:
    value = number(header.get(name, ""))
    return None if value is None else int(value)
