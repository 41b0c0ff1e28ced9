"""A live run from the page in a real browser: replayed, seen, stopped, and then in the table with its 3-D view."""

import threading
from contextlib import closing
from shutil import copy

import pytest

from benchmarks.streams.vicon_server import ViconServer
from mbkf.app import routes as module
from mbkf.app.server import AppServer
from mbkf.io.c3d_write import write_c3d
from mbkf.io.capture import read_capture
from mbkf.stream.discovery import Found
from mbkf.stream.found import FoundStream
from mbkf.stream.played import played
from mbkf.stream.replay import ReplaySettings
from mbkf.stream.replay import replay as replay_stream
from mbkf.trial.synth import synthesise
from tests.app.test_recordings import record
from tests.studies import study, walk_folder
from tests.viz.browsing import until

pytestmark = pytest.mark.slow

HOSTILE = "<img src=x onerror=\"document.title='harmed'\"> $& {1}"

FRAMED = "#scene canvas"


@pytest.fixture
def lab(tmp_path):
    made = AppServer(study(tmp_path / "lab"), workers=1)
    yield made
    made.close()


def text_of(page, selector):
    return f"(document.querySelector('{selector}')?.textContent || '')"


def replay(page, trial, body):
    page.select_option("select[name=source]", "file")
    page.select_option("select[name=trial]", trial)
    page.select_option("select[name=body]", body)
    page.click("dialog button.main")


def test_a_capture_is_replayed_stopped_and_joins_the_session(opened, lab):
    # A browser on a busy machine may draw later than the study's walk of 2.5 s ends.
    _, lasting = synthesise("squat", seconds=40.0, rate_hz=50.0)
    write_c3d(lasting.trial, lab.workspace.folder("P1") / "walk1.c3d")
    with opened(lab.url) as page:
        page.set_viewport_size({"width": 1280, "height": 800})
        page.click("button.live")
        assert page.evaluate("document.querySelector('dialog').contains(document.activeElement)")
        replay(page, "static", "standing")
        until(page, f"{text_of(page, 'dialog .told')}.startsWith('Recorded as live-')")
        first = page.text_content("dialog .told").removeprefix("Recorded as ")
        page.click("dialog p.again button")
        page.wait_for_selector("select[name=source]")
        assert page.input_value("select[name=body]") == "subject", "who stood still is known now"
        replay(page, "walk1", "subject")
        live = page.frame_locator("dialog iframe").frame_locator("iframe")
        live.locator(FRAMED).wait_for()
        inner = page.frames[-1]
        until(inner, "document.getElementById('state').textContent === 'live'")
        until(inner, "Number(document.getElementById('time').textContent.split(' ')[0]) > 0.5")
        page.click("dialog .stop")
        until(page, f"/Recorded as live-/.test({text_of(page, 'dialog .told')})")
        second = page.text_content("dialog .told").removeprefix("Recorded as ")
        assert second != first
        page.keyboard.press("Escape")
        until(page, "document.querySelector('dialog') === null")
        for name in (first, second):
            page.get_by_role("row", name=name).get_by_text("recorded live").wait_for()
        page.get_by_role("row", name=second).get_by_role("button", name="3-D").click()
        page.frame_locator("dialog iframe").locator(FRAMED).wait_for()
    ended = ("ERR_CONNECTION_RE", "before receiving a handshake")  # a live page that ended
    opened.errors[:] = [one for one in opened.errors if not any(text in one for text in ended)]


def test_a_download_is_named_after_its_trial(opened, lab):
    record(lab.workspace, "live-1")
    with opened(lab.url) as page:
        with page.expect_download() as waited:
            page.get_by_label("Export live-1 as").click()
            page.get_by_role("button", name="BVH").click()
        assert waited.value.suggested_filename == "live-1.bvh"
        assert waited.value.path().read_bytes().startswith(b"HIERARCHY")
        until(page, f"{text_of(page, '#told')} === 'live-1.bvh is saved'")


def test_names_of_streams_are_text_and_failures_are_told(opened, lab, monkeypatch):
    found = (
        FoundStream("lsl", HOSTILE, "lab", "", {"stream": HOSTILE}, 36, 120.0, 2),
        FoundStream("qualisys", "QTM", "10.0.0.2", "10.0.0.2:22232", {}, 0, 100.0, 0),
    )
    monkeypatch.setattr(module, "find_streams", lambda: Found(found, ()))
    with opened(lab.url) as page:
        page.click("button.live")
        until(page, "document.querySelectorAll('select.found option').length === 3")
        assert page.input_value("input[name=stream]") == HOSTILE
        listed = page.text_content("select.found option:nth-child(2)")
        assert listed == f"{HOSTILE} (LSL stream on lab; markers: 36, 120 Hz, force plates: 2)"
        page.select_option("select.found", "1")
        assert page.input_value("select[name=source]") == "qualisys"
        assert page.input_value("input[name=host]") == "10.0.0.2"
        assert page.input_value("input[name=port]") == "22232"
        assert page.title() == "P1 · mbkf" and page.locator("dialog img").count() == 0
        page.select_option("select[name=source]", "natnet")
        page.fill("input[name=local]", "nowhere.invalid")
        page.click("dialog button.main")
        until(page, f"{text_of(page, 'dialog .told')}.startsWith('The live run failed: ')")
        assert "\n" not in page.text_content("dialog .told")
        assert page.locator("dialog .told.bad").is_visible()
        page.keyboard.press("Escape")


def test_the_dialog_speaks_spanish_and_its_sentences_stay_within(opened, lab, monkeypatch):
    monkeypatch.setattr(module, "find_streams", lambda: Found((), ()))
    with opened(lab.url) as page:
        page.select_option("#language select", "es")
        page.click("button.live")
        page.wait_for_selector("select[name=source]")
        assert page.text_content("dialog button.main") == "Iniciar"
        page.locator("dialog p[role=status]:has-text('No se encontró')").wait_for()
        wide, seen = page.evaluate(
            "(({ scrollWidth, clientWidth }) => [scrollWidth, clientWidth])(document.querySelector('dialog .inside'))"
        )
        assert wide <= seen
        assert "undefined" not in page.text_content("dialog")


def test_an_export_that_fails_is_told_and_can_be_asked_for_again(opened, lab):
    folder = record(lab.workspace, "live-1")
    with opened(lab.url) as page:
        choice = page.get_by_label("Export live-1 as")
        choice.wait_for()
        (folder / "motion.h5").write_bytes(b"damaged")
        choice.click()
        page.get_by_role("button", name="GLB").click()
        until(page, "document.getElementById('told').className === 'bad'")
        assert "motion.h5" in page.text_content("#told")
        choice.click()
        assert page.get_by_role("button", name="GLB").is_enabled()
    opened.errors[:] = [one for one in opened.errors if "400 (Bad Request)" not in one]  # the refusal itself


def test_a_vicon_at_its_address_is_followed_and_recorded_as_a_capture(opened, lab):
    copy(walk_folder() / "subject.toml", lab.workspace.folder("P1"))
    walk = read_capture(walk_folder() / "trial.c3d")
    stream = played(walk)
    with closing(ViconServer(stream)) as server:
        rest = (stream, server, ReplaySettings(), threading.Event())
        sender = threading.Thread(target=replay_stream, args=rest)
        sender.start()
        with opened(lab.url) as page:
            page.click("button.live")
            page.select_option("select[name=source]", "xsens")
            assert page.locator("input[name=record]").is_hidden()
            page.select_option("select[name=source]", "vicon")
            assert page.input_value("input[name=port]") == "801"
            page.fill("input[name=port]", str(server.port))
            page.check("input[name=record]")
            page.click("dialog button.main")
            live = page.frame_locator("dialog iframe").frame_locator("iframe")
            live.locator(FRAMED).wait_for()
            sender.join()
            page.click("dialog .stop")
            until(page, f"/Recorded as live-/.test({text_of(page, 'dialog .told')})")
            page.keyboard.press("Escape")
            (file,) = lab.workspace.folder("P1").glob("recorded-*.c3d")
            page.get_by_role("row", name=file.stem).first.wait_for()
    kept = read_capture(file)
    assert kept.markers.names == walk.markers.names and len(kept.plates) == len(walk.plates)
    ended = ("ERR_CONNECTION_RE", "before receiving a handshake")  # a live page that ended
    opened.errors[:] = [one for one in opened.errors if not any(text in one for text in ended)]
