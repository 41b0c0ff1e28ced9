"""A capture's folders after its commands, and what is asked of them; numbers of results that are missing are NaN."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.io.results import Reconstruction
from mbkf.io.results_folder import ContactTold, Summary, read_reconstruction, read_summary


@dataclass(frozen=True)
class Trial:
    """A reconstructed capture.

    Attributes:
        data: Folder of the capture.
        out: Folder of what the commands wrote: texts, ``subject.toml``, ``result``.
    """

    data: Path
    out: Path

    @cached_property
    def result(self) -> Reconstruction | None:
        """The reconstruction; None where it failed."""
        folder = self.out / "result"
        return read_reconstruction(folder) if folder.is_dir() else None

    @cached_property
    def summary(self) -> Summary | None:
        """Its key numbers; None where it failed."""
        return None if self.result is None else read_summary(self.out / "result")

    def said(self, command: str) -> str:
        """The command's output as one line."""
        path = self.out / f"{command}.txt"
        return " ".join(path.read_text(encoding="utf-8").split()) if path.is_file() else ""

    def angles_deg(self, name: str) -> Array:
        """(T, 2) an angle of right and left side, degrees; one NaN without a result."""
        if self.result is None:
            return np.full((1, 2), np.nan)
        return np.rad2deg(np.column_stack([self.result.angle(f"{name}_{side}") for side in "rl"]))

    def range_deg(self, name: str) -> tuple[float, float]:
        """Least and greatest value of an angle of both sides, degrees."""
        angles = self.angles_deg(name)
        if np.isnan(angles).all():
            return np.nan, np.nan
        return float(np.nanmin(angles)), float(np.nanmax(angles))

    def sd_deg(self, name: str) -> float:
        """Median standard deviation of an angle, degrees: persons walk in and out of the volume."""
        return np.nan if self.result is None else float(np.rad2deg(np.nanmedian(self.result.angle_sd(name))))

    def word(self, part: str) -> str:
        """The verdict on a part; "" where nothing was judged."""
        verdict = None if self.summary is None else self.summary["verdict"]
        return "" if verdict is None else verdict["parts"][part]

    def supports(self) -> list[ContactTold]:
        """Contacts of parts that are no feet."""
        return (
            [] if self.summary is None else [c for c in self.summary["contacts"] if "foot" not in c["part"]]
        )
