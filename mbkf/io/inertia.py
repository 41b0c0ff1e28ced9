"""A person's own inertial parameters in the subject file: differences of segments from the reference body's table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import InvalidInput


@dataclass(frozen=True)
class SegmentInertia:
    """One segment beside the scaled table.

    Attributes:
        mass_factor: Mass over that of the table; moments of inertia about the centre of mass go with it.
        centre_shift_m: (3,) from the table's centre of mass, in the segment's frame, m.
        mass_factor_sd: Standard deviation of the factor.
        centre_shift_sd_m: (3,) standard deviation of the shift, m.
    """

    mass_factor: float = 1.0
    centre_shift_m: Array = field(default_factory=lambda: read_only(np.zeros(3)))
    mass_factor_sd: float = 0.0
    centre_shift_sd_m: Array = field(default_factory=lambda: read_only(np.zeros(3)))

    def __post_init__(self) -> None:
        numbers = [self.mass_factor, self.mass_factor_sd, *self.centre_shift_m, *self.centre_shift_sd_m]
        if not np.isfinite(numbers).all():
            raise InvalidInput("a segment's inertial parameters must be finite")
        if not self.mass_factor > 0.0:
            raise InvalidInput(f"a segment's mass_factor must be positive, got {self.mass_factor:g}")


def parse_inertia(table: Mapping[str, Mapping[str, object]]) -> dict[str, SegmentInertia]:
    """The segments of the subject file's table.

    Raises:
        InvalidInput: A mass is not positive or a number not finite.
        KeyError: An entry is missing.
        ValueError: A shift has not three coordinates.
    """
    return {
        name: SegmentInertia(
            _number(entry["mass_factor"]),
            _vector(name, entry["centre_shift_m"]),
            _number(entry["mass_factor_sd"]),
            _vector(name, entry["centre_shift_sd_m"]),
        )
        for name, entry in table.items()
    }


def _number(value: Any) -> float:
    return float(value)


def _vector(name: str, values: Any) -> Array:
    found = read_only(values)
    if found.shape != (3,):
        raise ValueError(f"the inertia of {name} needs three coordinates")
    return found
