"""A reconstruction as one self-contained page that plays it."""

from __future__ import annotations

from pathlib import Path

from mbkf.io.atomic import replacing
from mbkf.io.results import Reconstruction
from mbkf.viz.page import page
from mbkf.viz.scene.recording import recording


def playback_page(reconstruction: Reconstruction) -> str:
    """The page: 3-D scene, plots, play, pause, speed and slider; it loads nothing and needs no server."""
    return page(recording(reconstruction))


def write_playback(reconstruction: Reconstruction, path: str | Path) -> None:
    """Writes that page, whole or not at all.

    Raises:
        OSError: The file cannot be written.
    """
    text = playback_page(reconstruction)
    with replacing(path) as partial:
        partial.write_text(text, encoding="utf-8")
