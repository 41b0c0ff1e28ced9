"""The page benchmark's own judgement: what it counts as active, as inaccessible, and as the same result."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.app import sessions
from benchmarks.app.accessible import findings
from benchmarks.app.names import EVIL, active, evil_session
from benchmarks.app.path import differing, same
from benchmarks.app.sessions import BAD, WRONG_KG, new_user
from benchmarks.app.visit import until
from mbkf.errors import InvalidInput
from mbkf.io.capture import read_capture
from mbkf.io.results_folder import write_reconstruction
from mbkf.io.session import read_session
from mbkf.trial.results.summary import summarise
from tests.recordings import walk


def test_planted_elements_are_seen(browser):
    page = browser.new_page()
    page.set_content("<p>text</p>")
    assert active(page.main_frame) == 0.0
    page.set_content(f"<p>{EVIL[0]}</p>")
    page.wait_for_timeout(300)
    assert active(page.main_frame) >= 3.0, "a script that ran, an attribute, an image"
    page = browser.new_page()
    page.set_content(f'<a href="{EVIL[3]}">x</a>')
    assert active(page.main_frame) == 1.0


@pytest.mark.parametrize("planted", ["<script>window.hit=1</script>", '<iframe src="about:blank"></iframe>'])
def test_planted_elements_that_do_not_run_are_seen(browser, planted):
    page = browser.new_page()
    page.set_content("<p></p>")
    page.evaluate("(text) => { document.querySelector('p').innerHTML = text; }", planted)
    assert page.evaluate("window.hit") is None and active(page.main_frame) == 1.0


def test_planted_barriers_are_found(browser):
    page = browser.new_page()
    good = '<html lang="en"><title>t</title><main><h1>t</h1><label>x <input></label></main></html>'
    page.set_content(good)
    assert findings(page.main_frame) == []
    page.set_content(good.replace("<label>x <input></label>", "<input>"))
    assert any(one.startswith("label:") for one in findings(page.main_frame))


def test_results_are_the_same_or_not(tmp_path):
    r = walk()
    one = write_reconstruction(r, summarise(r), tmp_path / "one")
    other = write_reconstruction(replace(r, trial="x"), summarise(replace(r, trial="x")), tmp_path / "other")
    moved = replace(r, q=np.nextafter(r.q, 9.0))
    assert same(one, other)
    assert not same(one, write_reconstruction(moved, summarise(r), tmp_path / "moved"))
    more = {**summarise(r), "mass_kg": 1.0}
    assert not same(one, write_reconstruction(r, more, tmp_path / "more"))


def test_results_that_are_missing_differ(tmp_path):
    session = tmp_path / "lab" / "P"
    session.mkdir(parents=True)
    (session / "walk.c3d").write_bytes(b"damaged")
    assert differing(tmp_path / "lab", tmp_path / "batch") == 1.0


def test_sessions_are_as_told(tmp_path, monkeypatch):
    monkeypatch.setattr(sessions, "WALK_S", 1.0)
    session = new_user(tmp_path, seed=1)
    assert read_session(session / "session.toml").mass_kg == WRONG_KG
    assert sorted(path.name for path in session.glob("*.c3d")) == [
        BAD, "static1.c3d", "static2.c3d", "walk1.c3d", "walk2.c3d", "walk3.c3d", "walk4.c3d",
    ]  # fmt: skip
    assert len(read_capture(session / "walk1.c3d").markers.names) == 36
    assert not read_capture(session / BAD).markers.names


def test_names_are_attempts(tmp_path):
    session = evil_session(tmp_path)
    assert (
        len(list(session.glob("*.c3d"))) == 2 * len(EVIL) + 1
        and read_session(session / "session.toml").name == EVIL[1]
    )
    found = read_capture(next(session.glob("1 *.c3d")))
    assert EVIL[1] in found.markers.names and EVIL[1] in [event.label for event in found.events]
    assert EVIL[1] in [channel.name for channel in found.analog]
    assert set(EVIL) <= set(read_capture(next(session.glob("*.trc"))).markers.names)
    stated = read_session(session / "session.toml").trials
    assert sorted(one.excluded for one in stated.values()) == sorted(EVIL)


def test_waiting_ends():
    assert until(lambda: True) < 1.0
    with pytest.raises(InvalidInput, match="did not get there"):
        until(lambda: False, patience_s=0.05)
