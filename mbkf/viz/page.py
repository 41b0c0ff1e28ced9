"""Pages as one text: markup, style, scripts, data and meshcat's viewer, so that nothing else is ever loaded."""

from __future__ import annotations

import importlib.util
import json
import re
from collections.abc import Iterable, Mapping
from functools import cache
from html import escape
from pathlib import Path

from mbkf.errors import FileFormatError, UnknownName
from mbkf.viz.language import decimal_sign, languages, words
from mbkf.viz.translation import translated

ASSETS = Path(__file__).resolve().parent / "assets"

SCRIPTS = (
    "element.js", "app_words.js", "colours.js", "scene.js", "plot.js", "panel.js", "player.js", "live.js", "page.js",
)  # fmt: skip
"""Scripts of the 3-D page, in the order they are needed."""


def page(recording: dict[str, object] | None = None) -> str:
    """The 3-D page: it plays a recording (:mod:`mbkf.viz.scene.recording`), or its server's live stream without one."""
    return fill(
        "page.html",
        connect="'self'" if recording is None else "'none'",
        style=asset("page.css"),
        recording="" if recording is None else embedded("recording", recording),
        words=embedded_words("viewer", "live_page"),
        meshcat=viewer_script(),
        scripts=scripts(SCRIPTS),
    )


def document(
    language: str,
    title: str,
    style: str,
    sections: Iterable[tuple[str, str]],
    body: str,
    media: str = "'none'",
) -> str:
    """A report: a page without scripts, with links to its sections; texts of the library are said in its language.

    Args:
        language: Its code, e.g. "en".
        title: Of the window, plain text.
        style: Style sheets, one after another.
        sections: Identifier and title of each section that the page links to.
        body: Heading and sections, HTML.
        media: Sources of videos that the page may load, as a content security policy names them.
    """
    links = "".join(f'<a href="#{name}">{escape(text)}</a>' for name, text in sections)
    page = fill(
        "report.html",
        language=language, title=escape(title), style=style, links=links, body=body, media=media,
    )  # fmt: skip
    return translated(page, language)


BLUE_RED = "blue-red"
COLOURS = {BLUE_RED: ("#0072b2", "#d55e00"), "green-red": ("#00803c", "#c8102e")}
"""Colours of right and left. Laboratories draw the left red, and the right blue or green; the first pair is that of
M. Okabe and K. Ito (2008), which people who confuse red and green tell apart."""


def report_style(colours: str, *names: str) -> str:
    """Style sheets of a report, with colours of right and left.

    Args:
        colours: One of :data:`COLOURS`.
        names: Names of the style sheets.

    Raises:
        UnknownName: The colours do not exist.
    """
    if colours not in COLOURS:
        raise UnknownName("colours", colours, COLOURS)
    right, left = COLOURS[colours]
    own = f":root {{ --r: {right}; --l: {left}; }}" if colours != BLUE_RED else ""
    return "".join(asset(name) for name in names) + own


def fill(template: str, **parts: str) -> str:
    """An asset with its parts in the places of ``{{name}}``."""
    return re.sub(r"\{\{(\w+)\}\}", lambda place: parts[place[1]], asset(template))


@cache
def asset(name: str) -> str:
    """The text of a file of ``mbkf/viz/assets``."""
    return (ASSETS / name).read_text(encoding="utf-8")


def embedded(name: str, data: Mapping[str, object]) -> str:
    """Plain data as a script element that holds JSON, whatever its texts contain."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"), ensure_ascii=False)
    return f'<script type="application/json" id="{name}">' + text.replace("<", "\\u003c") + "</script>"


def embedded_words(*sections: str) -> str:
    """The texts of sections of the language files, in every language, for the scripts of a page."""
    known = {
        code: {
            "name": name,
            "decimal": decimal_sign(code),
            "words": {key: text for one in sections for key, text in words(code, one).items()},
        }
        for code, name in languages().items()
    }
    return embedded("words", known)


@cache
def viewer_script() -> str:
    """The viewer of the installed meshcat (with three.js inside) below its licences, escaped for a script element.

    Raises:
        FileFormatError: The installed meshcat brings no viewer.
    """
    found = importlib.util.find_spec("meshcat")
    folder = Path(found.origin).parent / "viewer" / "dist" if found and found.origin else Path("meshcat")
    try:
        names = (folder.parent / "LICENSE", folder / "main.min.js.LICENSE.txt")
        licences = "\n".join(path.read_text(encoding="utf-8") for path in names if path.is_file())
        script = (folder / "main.min.js").read_text(encoding="utf-8")
    except OSError as error:
        raise FileFormatError(
            folder, f"meshcat's viewer is missing ({error}); reinstall the package meshcat"
        ) from error
    return _in_script(f"/*\n{licences.replace('*/', '* /')}\n*/\n{script}")


def scripts(names: Iterable[str]) -> str:
    """Scripts of the assets, one after another, escaped for a script element."""
    return _in_script("\n".join(asset(name) for name in names))


def _in_script(text: str) -> str:
    """A script in which nothing ends its element early."""
    return text.replace("</script", "<\\/script").replace("<!--", "<\\!--")
