"""Public tables that state no units, with the statements of their makers' descriptions.

RepoIMU (Szczęsna, Skurowski, Pruszowski, Pęszor, Paszkuta, Wojciechowski 2016): m/s², rad/s, fields relative to the
Earth's, quaternions of the cameras.
"""

from __future__ import annotations

from dataclasses import dataclass

from mbkf.io.imu.table_defaults import NO_DEFAULTS, TableDefaults
from mbkf.io.imu.table_text import TableText

_SEARCHED = 30


@dataclass(frozen=True)
class KnownTable:
    """A kind of table.

    Attributes:
        marks: Cells, in lower case, that all stand above the readings.
        defaults: Statements of its description.
    """

    marks: tuple[str, ...]
    defaults: TableDefaults


KNOWN = (
    KnownTable(
        ("vicon orientation", "imu acceleration", "imu gyroscope", "imu magnetometer"),
        TableDefaults(
            {"acc": "m/s2", "gyr": "rad/s", "mag": "au"}, frame="orientation by cameras, in their world, z up"
        ),
    ),
)


def defaults_of(text: TableText) -> TableDefaults:
    """Statements for a table; empty ones for an unknown kind."""
    cells = {cell.lower() for _, row in text.rows[:_SEARCHED] for cell in row}
    return next((known.defaults for known in KNOWN if cells.issuperset(known.marks)), NO_DEFAULTS)
