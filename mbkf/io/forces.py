"""Ground reactions as OpenSim stores them: force, point of application and torque there per plate or foot.

:mod:`mbkf.io.force_names` reads the names of the columns.
"""

from __future__ import annotations

from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.force_table import ForceTable, plates_of_table
from mbkf.io.records import PlateReadings
from mbkf.io.storage import Table, promised_rows, read_storage
from mbkf.io.text import even_rate, number


def read_forces_mot(path: str | Path, options: CaptureOptions) -> tuple[PlateReadings, ...]:
    """Ground reactions of a MOT (or STO) file in m, N and N m: one set per plate or foot, in the order of the columns.

    A file with fewer rows than it promises is whole if it lasts until the end of the trial, or of the range in its own
    header. Without an axis in the options, the one that carries the weight points up, else OpenSim's y.

    Raises:
        FileFormatError: The file is missing, no table or cut short, columns of a set are missing, or the times
            are not evenly spaced.
        InvalidInput: A force, point or torque is not a number.
        UnknownName: No column follows a known naming; lists what was found.
    """
    table = read_storage(path, check_rows=False)
    rate_hz = even_rate(Path(path), table.times_s)
    _check_rows(Path(path), table, rate_hz, options)
    forces = ForceTable(str(path), table.names, table.columns, rate_hz, float(table.times_s[0]), metres=None)
    return plates_of_table(forces, options)


def _check_rows(path: Path, table: Table, rate_hz: float, options: CaptureOptions) -> None:
    """Compares the rows with those promised; fewer are enough where they last as long as they should."""
    promised, found = promised_rows(table), len(table.times_s)
    if promised is None or promised == found:
        return
    ends = [options.trial_end_s] if options.trial_end_s is not None else []
    stated = [number(word) for word in table.header.get("range", "").split()]
    ends += [end for end in stated[1:2] if end is not None]
    lasting = any(table.times_s[-1] + 1.5 / rate_hz >= end for end in ends)
    if promised > found and not lasting:
        reason = f"cut short: {promised} rows promised, {found} present"
        until = f", and they end at {table.times_s[-1]:.3f} s" if ends else ""
        raise FileFormatError(path, f"{reason}{until}; copy or export it again")
    options.notes.append(f"{path.name} promises {promised} rows and has {found}")
