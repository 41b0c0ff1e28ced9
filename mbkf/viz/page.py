"""The page as one piece of text: markup, style, scripts and meshcat's viewer, so that nothing else is ever loaded."""

from __future__ import annotations

import importlib.util
import json
from functools import cache
from pathlib import Path

from mbkf.errors import FileFormatError

ASSETS = Path(__file__).resolve().parent / "assets"

SCRIPTS = (
    "element.js", "colours.js", "scene.js", "plot.js", "panel.js", "player.js", "live.js", "page.js",
)  # fmt: skip
"""The page's own scripts, in the order they are needed."""


def page(recording: dict[str, object] | None = None) -> str:
    """The page.

    Args:
        recording: What to play: ``scene`` and ``rows`` (see :mod:`mbkf.viz.scene.recording`); the page asks its
            server for a live stream when None.

    Raises:
        FileFormatError: The installed meshcat brings no viewer.
    """
    parts = {
        "connect": "'self'" if recording is None else "'none'",
        "page.css": asset("page.css"),
        "recording": "" if recording is None else embedded("recording", recording),
        "meshcat": viewer_script(),
        "scripts": _in_script("\n".join(asset(name) for name in SCRIPTS)),
    }
    text = asset("page.html")
    for name, part in parts.items():
        text = text.replace("{{" + name + "}}", part, 1)
    return text


def asset(name: str) -> str:
    """The text of a file of ``mbkf/viz/assets``."""
    return (ASSETS / name).read_text(encoding="utf-8")


def embedded(name: str, data: dict[str, object]) -> str:
    """Plain data as a script element that holds JSON, whatever its texts contain."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"), ensure_ascii=False)
    return f'<script type="application/json" id="{name}">' + text.replace("<", "\\u003c") + "</script>"


def viewer_script() -> str:
    """Meshcat's viewer, as it may stand in a script element.

    Raises:
        FileFormatError: The installed meshcat brings no viewer.
    """
    return _in_script(_viewer())


@cache
def _viewer() -> str:
    """Meshcat's viewer (with three.js inside), below the licences it comes under."""
    found = importlib.util.find_spec("meshcat")
    folder = Path(found.origin).parent / "viewer" / "dist" if found and found.origin else Path("meshcat")
    try:
        names = (folder.parent / "LICENSE", folder / "main.min.js.LICENSE.txt")
        licences = "\n".join(path.read_text(encoding="utf-8") for path in names if path.is_file())
        return f"/*\n{licences.replace('*/', '* /')}\n*/\n" + (folder / "main.min.js").read_text(
            encoding="utf-8"
        )
    except OSError as error:
        raise FileFormatError(
            folder, f"meshcat's viewer is missing ({error}); reinstall the package meshcat"
        ) from error


def _in_script(text: str) -> str:
    """A script that may stand inside a page: nothing in it ends the element early."""
    return text.replace("</script", "<\\/script").replace("<!--", "<\\!--")
