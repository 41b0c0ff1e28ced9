"""The page as one piece of text: markup, style, scripts and meshcat's viewer, so that nothing else is ever loaded."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

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


@cache
def viewer_script() -> str:
    """The viewer of meshcat 0.3.2 (with three.js inside) below its licences, escaped for a script element."""
    licences = "\n".join(asset(f"meshcat/{name}") for name in ("LICENSE", "main.min.js.LICENSE.txt"))
    return _in_script(f"/*\n{licences.replace('*/', '* /')}\n*/\n{asset('meshcat/main.min.js')}")


def _in_script(text: str) -> str:
    """A script that may stand inside a page: nothing in it ends the element early."""
    return text.replace("</script", "<\\/script").replace("<!--", "<\\!--")
