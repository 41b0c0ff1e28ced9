"""A figure as a file that states its program, whole or not at all."""

from __future__ import annotations

from pathlib import Path

from matplotlib.figure import Figure

from mbkf.io.atomic import replacing
from mbkf.io.written import MARK


def write_figure(figure: Figure, path: str | Path, dpi: float | None = None) -> None:
    """Writes a figure as the kind of file that its suffix names (.png, .svg, .pdf).

    Args:
        figure: The figure.
        path: The file.
        dpi: Dots per inch of a .png; the figure's own by default.

    Raises:
        ProtectedFile: The file was read, or mbkf did not write it.
        OSError: The file cannot be written.
    """
    place = "Software" if Path(path).suffix.lower() == ".png" else "Creator"
    with replacing(path) as partial:
        figure.savefig(partial, dpi=dpi or "figure", metadata={place: MARK})
