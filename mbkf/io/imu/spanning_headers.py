"""Tables with names in two rows: a quantity that spans several cells above, and the axes below it.

``Time (s);IMU Acceleration;;;IMU Gyroscope;;`` over ``;X;Y;Z;X;Y;Z`` becomes one row of names.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from mbkf.io.imu.column_names import names_quantity, split_unit, time_unit
from mbkf.io.imu.table_text import TableText

_AXES = frozenset("wxyz")
_SEARCHED = 100


def joined_header(text: TableText) -> TableText:
    """The table with one row of names; other tables stay as they are."""
    for k in range(min(len(text.rows) - 1, _SEARCHED)):
        (_, above), (number, below) = text.rows[k : k + 2]
        if _spans(above, below):
            rows = [*text.rows[:k], (number, _joined(above, below)), *text.rows[k + 2 :]]
            return replace(text, rows=rows)
    return text


def _spans(above: Sequence[str], below: Sequence[str]) -> bool:
    """True for quantities over a row of axes."""
    axes = [cell for cell in below if cell and time_unit(cell) is None]
    only_axes = len(axes) > 2 and all(split_unit(cell)[0].strip().lower() in _AXES for cell in axes)
    return only_axes and any(names_quantity(cell) for cell in above)


def _joined(above: Sequence[str], below: Sequence[str]) -> list[str]:
    """One name per column: quantity, axis and unit; where there is no axis, the cell above."""
    names, group = list[str](), ""
    for k in range(max(len(above), len(below))):
        upper, lower = (row[k] if k < len(row) else "" for row in (above, below))
        group = upper or group
        axis, unit = split_unit(lower)
        if axis.strip().lower() not in _AXES:
            names.append(lower or upper)
            continue
        quantity, stated = split_unit(group)
        unit = unit or stated
        names.append(f"{quantity.strip()} {axis.strip()}" + (f" [{unit}]" if unit else ""))
    return names
