"""Statements that a table leaves to its maker's description."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class TableDefaults:
    """Statements of a maker's description that replace missing ones of the table.

    Attributes:
        units: Unit by quantity.
        kind: Quantity of columns that are called x, y and z only.
        sensor: Name of a sensor that columns do not name.
        frame: World of the orientations.
    """

    units: Mapping[str, str]
    kind: str = ""
    sensor: str = ""
    frame: str = ""


NO_DEFAULTS = TableDefaults({})
