"""Norms as a file holds them: bands under the file's own names, units and points of the cycle, and its statements."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from mbkf.conventions import Array
from mbkf.io.norms import Speeds

MEASURE = "measure"
"""Quantity of a band that is one number."""


NAMES, OWN = "names", "mbkf"
"""Statement of a table whose curves have mbkf's names, units and signs."""


@dataclass(frozen=True)
class RawBand:
    """A band under the file's own name.

    Attributes:
        label: The file's name of the curve.
        component: "X", "Y" or "Z", where the name has three curves; else empty.
        group: Persons or speeds that it is of, where a file has several; else empty.
        kind: Kind of movement.
        quantity: "angle", "torque", "power", "reaction" or "measure" where the file states it; else empty.
        unit: As the file or its format states it; else empty.
        persons: Number of persons; 0 where the file does not state it.
        speeds: Speeds that the band is for, m/s; None without.
        percent: (K,) points of the cycle; empty of a measure.
        mean, sd: (K,) mean and standard deviation.
    """

    label: str
    mean: Array
    sd: Array
    percent: Array
    component: str = ""
    group: str = ""
    kind: str = "walk"
    quantity: str = ""
    unit: str = ""
    persons: int = 0
    speeds: Speeds | None = None


@dataclass(frozen=True)
class RawNorms:
    """Norms of a file.

    Attributes:
        form: The kind of file, in words.
        bands: Its bands.
        statements: What its comments state, by word: "source", "convention", "age" …
    """

    form: str
    bands: tuple[RawBand, ...]
    statements: Mapping[str, str] = field(default_factory=dict)

    @property
    def groups(self) -> tuple[str, ...]:
        """Names of its groups, in order; one empty name where it has none."""
        return tuple(dict.fromkeys(one.group for one in self.bands))
