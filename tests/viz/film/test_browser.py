"""A browser is looked for in turn; without one, or without what drives it, one sentence says what to install."""

import sys

import pytest

from mbkf.errors import InvalidInput, MissingDependency
from mbkf.viz.film import browser as module
from mbkf.viz.film.browser import shown_page, ways_to_start


def test_a_browser_on_the_path_comes_first(tmp_path, monkeypatch):
    for name in ("google-chrome", "chromium"):
        (tmp_path / name).write_text("#!/bin/sh\n")
        (tmp_path / name).chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    ways = ways_to_start()
    assert ways[0] == {"executable_path": str(tmp_path / "chromium")}
    assert ways[1:] == [{}, {"channel": "chrome"}, {"channel": "msedge"}]
    monkeypatch.setenv("PATH", "")
    assert ways_to_start() == ways[1:]


def test_without_a_browser_one_sentence_says_what_to_install(tmp_path, monkeypatch):
    pytest.importorskip("playwright", reason="playwright is not installed: pip install '.[film]'")
    monkeypatch.setattr(module, "ways_to_start", lambda: [{"executable_path": str(tmp_path / "none")}])
    wanted = r"Chromium, Chrome or Edge.*playwright install"
    with pytest.raises(InvalidInput, match=wanted) as told, shown_page("", 10, 10):
        pass
    assert "\n" not in str(told.value)


def test_without_its_driver_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "playwright", None)
    with (
        pytest.raises(MissingDependency, match=r"pip install playwright \(in a clone"),
        shown_page("", 10, 10),
    ):
        pass


@pytest.mark.slow
def test_a_page_is_drawn_without_the_network_and_its_errors_are_told(filming):
    words = "<title>here</title><body>text</body>"
    with shown_page(words, 320, 200) as page:
        assert page.title() == "here"
        assert page.evaluate("[innerWidth, innerHeight, navigator.onLine]") == [320, 200, False]
    with (
        pytest.raises(InvalidInput, match=r"cannot draw the page.*no hands"),
        shown_page(words, 320, 200) as page,
    ):
        page.evaluate("() => { throw new Error('no hands'); }")
