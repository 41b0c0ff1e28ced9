"""The page of a result: self-contained, and small."""

import json
import re

from mbkf.viz.scene.playback import playback_page, write_playback
from mbkf.viz.scene.recording import recording
from tests.recordings import walk


def test_the_page_holds_the_rows(tmp_path):
    path = tmp_path / "new" / "walk.html"
    write_playback(walk(), path)
    text = path.read_text(encoding="utf-8")
    assert text == playback_page(walk())
    (held,) = re.findall(r'id="recording">(.*?)</script>', text)
    data = json.loads(held)
    assert data["scene"]["title"] == "walk <1>"
    assert data == recording(walk())
    assert len(text) < 2_000_000
