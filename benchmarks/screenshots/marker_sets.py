"""Pictures of a marker set's page, and of the marker editor on a standing trial."""

from __future__ import annotations

from pathlib import Path

from benchmarks.app.visit import browser
from benchmarks.screenshots.picture import Taken, Taking, still
from mbkf.io.capture import read_capture
from mbkf.model.protocol import load_protocol
from mbkf.trial.protocol.editing import starting_set
from mbkf.trial.protocol.standing import stand_beside
from mbkf.viz.protocol.edit import EditPage
from mbkf.viz.protocol.page import show_page

SHOWN = "plug_in_gait"
EDITED, DOUBTFUL = "gait2354_walk/subject01_static.trc", "R.Toe.Tip"
"""Standing trial with names that no set knows, and one of its markers."""

SIZE = {"width": 1200, "height": 760}


def marker_set_pictures(scratch: Path, data: Path) -> Taking:
    """Takes them.

    Args:
        scratch: An empty folder.
        data: Folder of the shared captures.
    """
    shown = scratch / "set.html"
    shown.write_text(show_page(load_protocol(SHOWN)), encoding="utf-8")
    protocol, capture = starting_set(read_capture(data / EDITED), None)
    editor = EditPage(
        protocol, stand_beside(capture, protocol, lambda *_: None), scratch / "my_markers.toml", port=0
    )
    with browser() as made:
        page = made.new_page(viewport=SIZE)
        page.goto(shown.absolute().as_uri())
        page.get_by_role("button", name="front", exact=True).click()
        yield Taken("screenshot_show_set", still(page))
        page.goto(editor.url)
        page.get_by_role("button", name="front", exact=True).click()
        page.locator(".item", has_text=DOUBTFUL).first.click()
        yield Taken("screenshot_edit_set", still(page))
    editor.close()
