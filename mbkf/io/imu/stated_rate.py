"""Sample rate that stands in words above a table: ``// Sample rate: 50.0Hz``, ``Frequency: 100``.

A frequency counts where it is called that of sampling, or begins its cell: other ones are corners of filters.
"""

from __future__ import annotations

import re

from mbkf.io.imu.table_text import TableText

_RATE = re.compile(
    r"(?:\b(?:update|sample|sampling|output|data|frame)[\s_]*rate|\b(?:sample|sampling)[\s_]*frequency"
    r"|(?:^[\s#/%]*|[;,|]\s*)frequency)\s*(?:\[hz\]|\(hz\))?"
    r"[\s:=,;]+([0-9]+(?:\.[0-9]+)?)",
    re.IGNORECASE,
)


def rate_above(text: TableText, head: int) -> float | None:
    """Sample rate in Hz that a comment or a row above the names states; None without one, or where several differ.

    Args:
        text: The table.
        head: Index of the row of names.
    """
    lines = [*text.comments, *(";".join(row) for _, row in text.rows[:head])]
    found = {float(match[1]) for line in lines for match in _RATE.finditer(line)} - {0.0}
    return found.pop() if len(found) == 1 else None
