"""Figures of the thesis's studies: one style, one colour per filter, and how a figure is named."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


TRUTH, BLUE, ORANGE, GREEN, GREY = "#111111", "#1f6fb4", "#e06c10", "#2a9150", "#9aa0a6"
SHADE = "#dfe2e5"
"""Stretches without markers, and statistical bands."""


@dataclass(frozen=True)
class Drawing:
    """A figure with its ``number`` in the thesis ("own" for one of ours), ``title`` and what to see in it."""

    number: str
    title: str
    figure: Figure
    note: str = ""

    @property
    def file(self) -> str:
        """Name of its file."""
        words = re.sub(r"[^a-z0-9 ]", "", self.title.lower()).split()[:4]
        stem = self.number if self.number != "own" else "own_" + "_".join(words)
        return f"figure_{stem.replace('.', '_')}.svg"


def axes(rows: int = 1, columns: int = 1, height: float = 2.6) -> tuple[Figure, list[Axes]]:
    """An empty figure in the style of all figures here.

    Args:
        rows: Rows of axes.
        columns: Columns of axes.
        height: Height of a row, inches.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.2, height * rows), layout="constrained")
    made = [figure.add_subplot(rows, columns, k + 1) for k in range(rows * columns)]
    for one in made:
        one.spines[["top", "right"]].set_visible(False)
        one.grid(color="#e4e6e8", linewidth=0.7)
        one.tick_params(labelsize=8)
    return figure, made


def labelled(one: Axes, x: str, y: str) -> None:
    """Names both axes, indices set low.

    Args:
        one: The axes.
        x: Name of the horizontal axis with its unit, "" for none.
        y: Name of the vertical axis.
    """
    one.set_xlabel(lowered(x), fontsize=9)
    one.set_ylabel(lowered(y), fontsize=9)


def lowered(text: str) -> str:
    """Text with its indices set low, as in τ_1; θ' stands for a rate."""
    dotted = re.sub(r"(\w)'(_\w)?", lambda found: rf"$\dot{{{found[1]}}}{found[2] or ''}$", text)
    return re.sub(r"(?<![\w$}])(\w)_(\w)\b", r"$\1_\2$", dotted)


def legend(one: Axes, columns: int = 4) -> None:
    """A legend above the axes, to the right."""
    one.legend(fontsize=8, frameon=False, ncols=columns, loc="lower right", bbox_to_anchor=(1.0, 1.0))
