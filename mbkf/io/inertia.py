"""A person's own inertial parameters in the subject file: differences of segments from the reference body's table."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import InvalidInput
from mbkf.io import fields
from mbkf.io.toml import Entries

MASS_FACTORS, FARTHEST_SHIFT_M = (0.05, 20.0), 0.5
"""Bounds of persons: of a segment's mass over the table's, and of the shift of its centre of mass."""

_MASS_FACTOR = fields.number("mass_factor", "mass over that of the table", MASS_FACTORS, required=True)
_CENTRE = fields.numbers(
    "centre_shift_m", "centre of mass from that of the table", 3, FARTHEST_SHIFT_M, "m", required=True
)
_MASS_FACTOR_SD = fields.number("mass_factor_sd", "its standard deviation", (0.0, 10.0), required=True)
_CENTRE_SD = fields.numbers(
    "centre_shift_sd_m", "its standard deviation", 3, FARTHEST_SHIFT_M, "m", required=True
)
INERTIA = fields.record("inertia", _MASS_FACTOR, _CENTRE, _MASS_FACTOR_SD, _CENTRE_SD)
"""Entries of a segment's inertia in a subject file."""


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


def parse_inertia(read: Entries) -> SegmentInertia:
    """The inertia of one segment in a subject file.

    Raises:
        FileFormatError: An entry is missing, or a person cannot have it.
    """
    return SegmentInertia(
        read.need(_MASS_FACTOR),
        read_only(read.need(_CENTRE)),
        read.need(_MASS_FACTOR_SD),
        read_only(read.need(_CENTRE_SD)),
    )
