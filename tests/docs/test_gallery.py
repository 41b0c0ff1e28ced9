"""The gallery's examples run, and its pictures and printed lines are theirs."""

import re

import numpy as np
import pytest
from PIL import Image

from docs._extensions import gallery
from docs.gallery.make import EXAMPLES, HERE, draw

NUMBER = re.compile(r"[+-]?\d+(?:\.\d+)?")
MOST_BYTES = 60_000
MOST_LINES = 60


def size(picture):
    with Image.open(picture) as opened:
        return opened.size


@pytest.mark.slow
@pytest.mark.usefixtures("real_data")
@pytest.mark.parametrize("script", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_draws_the_picture_that_the_page_shows(script, tmp_path):
    """``python docs/gallery/make.py NAME`` draws one anew whose output changed."""
    draw(script, tmp_path)
    drawn, kept = ((folder / f"{script.stem}.txt").read_text(encoding="utf-8") for folder in (tmp_path, HERE))
    assert NUMBER.sub("#", drawn) == NUMBER.sub("#", kept)
    found, shown = (np.array(NUMBER.findall(text), float) for text in (drawn, kept))
    np.testing.assert_allclose(found, shown, rtol=0.02, atol=0.11)  # of other processors and libraries
    assert size(tmp_path / f"{script.stem}.png") == size(HERE / f"{script.stem}.png")


def test_the_page_shows_every_example():
    page = (HERE.parent / "gallery.md").read_text(encoding="utf-8")
    shown = page.partition("```{gallery}\n")[2].partition("```")[0].split()
    assert sorted(shown) == [path.stem for path in EXAMPLES]


@pytest.mark.parametrize("script", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_is_short_and_states_its_capture(script):
    text = script.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= MOST_LINES
    assert script.with_suffix(".png").stat().st_size <= MOST_BYTES
    (capture,) = re.findall(r"^Capture: (\w+)$", text, re.MULTILINE)
    assert f'"{capture}"' in text and "https://" in gallery.source(capture)


def test_a_capture_that_the_page_on_captures_lacks_is_refused():
    with pytest.raises(ValueError, match="nowhere"):
        gallery.source("nowhere")
