"""A trial's page in a real browser: events are moved, added, deleted and undone, another trial lies beside."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.clinic.made_video import READ_NUMBER, VIDEO_HZ, numbered_video
from mbkf.app.server import AppServer
from mbkf.io.results_folder import write_result_files
from mbkf.io.session import SESSION_FILE, EventKind, FootEvent, read_session
from mbkf.study.batch.curves import read_curves
from mbkf.study.batch.trial import CURVES_FILE
from mbkf.trial.results.summary import summarise
from tests.recordings import walk
from tests.studies import runs_here, study
from tests.viz.browsing import until
from tests.waiting import PATIENCE_S

pytestmark = pytest.mark.slow

LOADED = "Boolean(window.mbkf && mbkf.view.seenPelvis && viewer.strip)"
"""True once the page can be used; before that ``viewer`` is the element of this id."""


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    folder = study(tmp_path_factory.mktemp("look") / "lab", persons=2, trials=2)
    with runs_here():
        made = AppServer(folder, workers=1)
        made.runs.start("P1")
        assert made.runs.wait(lambda: made.runs.state("P1").state == "finished", PATIENCE_S)
    yield made
    made.close()


@pytest.fixture
def page(opened, server):
    with opened(server.url) as page:
        page.set_viewport_size({"width": 1280, "height": 720})
        page.goto(f"http://127.0.0.1:{server.port}/trial/look?session=P1&trial=walk1")
        until(page, LOADED)
        page.evaluate(
            "viewer.events.mergeMs = 60000"
        )  # keys pressed by a slow machine follow each other, too
        yield page
        server.workspace.change_events("P1", "walk1", server.workspace.events("P1", "walk1"), None)


def by_hand(server):
    file = server.workspace.root / "P1" / SESSION_FILE
    return read_session(file).trial("walk1").events if file.is_file() else None


def starts(server):
    table = read_curves(server.workspace.result("P1", "walk1") / CURVES_FILE)
    return sorted(set(zip(table["side"].to_pylist(), table["start_s"].to_pylist(), strict=True)))


def saved(page):
    until(
        page,
        "viewer.strip.said.textContent.startsWith('Saved') && !viewer.saving.waiting && !viewer.saving.busy",
    )


def chosen(page, side, kind):
    """Focuses the first event of its kind; returns its time."""
    event = page.locator(f".{side} .event.{kind}").first
    event.focus()
    return float(event.get_attribute("aria-valuenow"))


def test_an_event_moved_with_the_keyboard_changes_the_session_file_and_the_curves(page, server):
    before = dict(starts(server))
    at = chosen(page, "right", "strike")
    assert at == before["right"] and by_hand(server) is None
    frame = page.evaluate("viewer.strip.frame")
    assert (
        page.evaluate(
            "Math.abs(mbkf.recording.times[mbkf.frame] - viewer.events.get(viewer.strip.chosen).time_s)"
        )
        < 0.01
    )
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Shift+ArrowRight")
    page.keyboard.press("ArrowLeft")
    saved(page)
    (moved,) = [one.time_s for one in by_hand(server) if abs(one.time_s - at) < 0.3 and one.side == "right"]
    assert moved == pytest.approx(at + 11 * frame, abs=1e-9)
    assert dict(starts(server))["right"] == moved and dict(starts(server))["left"] == before["left"]
    assert page.locator(".event.found").count() == 0 and page.locator(".was").count() > 0
    page.keyboard.press("Control+z")
    saved(page)
    assert page.locator(".event.hand").count() == 0, "moves that follow each other are undone at once"
    assert by_hand(server) is None and dict(starts(server)) == before


def test_events_are_deleted_added_and_taken_back(page, server):
    count = page.locator(".event").count()
    chosen(page, "left", "strike")
    page.keyboard.press("ArrowDown")
    assert page.evaluate("viewer.events.get(viewer.strip.chosen).kind") == "off", "the next one of that foot"
    page.keyboard.press("Delete")
    assert page.locator(".event").count() == count - 1
    assert page.evaluate("document.activeElement.classList.contains('event')"), "the focus is not lost"
    page.locator("#scrub").fill("120")
    page.get_by_role("button", name="Add: Right toe-off").press("Enter")
    assert page.locator(".event").count() == count
    saved(page)
    (added,) = [one for one in by_hand(server) if abs(one.time_s - 1.2) < 1e-6]
    assert (added.side, added.kind.value) == ("right", "off")
    page.get_by_role("button", name="Undo").click()
    page.get_by_role("button", name="Undo").click()
    assert page.locator(".event.found").count() == count
    page.get_by_role("button", name="Redo").click()
    assert page.locator(".event").count() == count - 1
    page.get_by_role("button", name="Back to the detected events").click()
    assert page.locator(".event.found").count() == count


@pytest.mark.parametrize("own", [True, False])
def test_events_that_another_page_set_are_chosen_by_the_person(page, server, own):
    theirs = (FootEvent("left", EventKind.OFF, 0.5),)
    server.workspace.change_events("P1", "walk1", None, theirs)
    asked = []

    def answer(dialog):
        asked.append(dialog.message)
        (dialog.accept if own else dialog.dismiss)()

    page.on("dialog", answer)
    chosen(page, "right", "strike")
    page.keyboard.press("Delete")
    saved(page)
    assert len(asked) == 1 and "other events meanwhile: 1, yours:" in asked[0]
    until(page, f"viewer.events.list.length {'>' if own else '==='} 1")
    assert (by_hand(server) == theirs) is not own
    chosen(page, "left", "off")
    page.keyboard.press("ArrowRight")
    saved(page)
    assert len(asked) == 1 and len(by_hand(server)) == page.evaluate("viewer.events.list.length")
    page.remove_listener("dialog", answer)


def test_an_event_is_dragged_and_one_comes_with_a_double_click(page, server):
    at = chosen(page, "right", "strike")
    box = page.locator(".right .event.strike").first.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 20, y, steps=4)
    page.mouse.move(x + 40, y, steps=4)
    page.mouse.up()
    width = page.locator(".right .inner").bounding_box()["width"]
    span = np.ptp(page.evaluate("viewer.events.span"))
    now = float(page.locator(".right .event.strike").first.get_attribute("aria-valuenow"))
    assert now == pytest.approx(at + 40 * span / width, abs=page.evaluate("viewer.strip.frame"))
    count = page.locator(".left .event.off").count()
    lane = page.locator("#strip .track.left").bounding_box()
    page.mouse.dblclick(lane["x"] + 0.68 * lane["width"], lane["y"] + 0.8 * lane["height"])
    assert page.locator(".left .event.off").count() == count + 1
    saved(page)


def test_another_trial_lies_beside_and_its_curves_are_drawn(page):
    assert page.evaluate("viewer.ghost") is None
    page.get_by_label("Other trial").select_option("walk2")
    until(page, "Boolean(viewer.ghost && viewer.ghost.body.visible)")
    page.locator("#scrub").fill("150")
    same = "[0, 1, 2].every((k) => Math.abs(viewer.ghost.body.localToWorld(viewer.ghost.segments[0].position.clone())"
    same += ".getComponent(k) - mbkf.view.viewer.scene.localToWorld(mbkf.view.segments[0].position.clone())"
    same += ".getComponent(k)) < 0.05)"
    until(page, same)  # the same walk, laid over itself, is where it is
    knee = "mbkf.panel.other(mbkf.panel.quantities.get('angle:knee_angle_r'))"
    own = "mbkf.recording.series(mbkf.panel.quantities.get('angle:knee_angle_r'))"
    assert page.evaluate(f"Math.abs({knee}.values[60] - {own}.values[60]) < 1")
    page.get_by_label("Alignment of the trials").select_option("time")
    assert page.evaluate("viewer.ghost.strikes") is None
    page.get_by_label("Other trial").select_option("")
    until(page, "viewer.ghost === null")


def turned(r, turn, shift):
    """A reconstruction in which the same is done elsewhere in the room, in another direction."""
    q, (c, s) = r.q.copy(), (np.cos(turn), np.sin(turn))
    q[:, :2] = r.q[:, :2] @ np.array([[c, s], [-s, c]]) + shift
    x, y, z, w = r.q[:, 3:7].T
    c, s = np.cos(turn / 2), np.sin(turn / 2)
    q[:, 3:7] = np.column_stack([c * x - s * y, c * y + s * x, c * z + s * w, c * w - s * z])
    return replace(r, q=q)


def test_a_walk_in_another_direction_is_laid_over_by_its_cycles(opened, server):
    for name, r in (("walk1", walk()), ("walk2", turned(walk(), 2.5, [1.0, -2.0]))):
        place = server.workspace.out / "P2" / name
        place.mkdir(parents=True)
        write_result_files(r, summarise(r), place)
    at = "mbkf.view.viewer.scene.worldToLocal(viewer.ghost.body.localToWorld("
    at += "viewer.ghost.segments[S].position.clone()))"
    fresh = "viewer.ghost.body.updateWorldMatrix(true, true)"
    with opened(server.url) as page:
        page.goto(f"http://127.0.0.1:{server.port}/trial/look?session=P2&trial=walk1")
        until(page, LOADED)
        page.get_by_label("Other trial").select_option("walk2")
        until(page, "Boolean(viewer.ghost && viewer.ghost.body.visible)")
        page.locator("#scrub").fill("60")
        page.evaluate(fresh)
        for segment in range(page.evaluate("mbkf.view.segments.length")):
            there = page.evaluate(at.replace("S]", f"{segment}]") + ".toArray()")
            here = page.evaluate(f"mbkf.view.segments[{segment}].position.toArray()")
            np.testing.assert_allclose(there, here, atol=0.02)
        page.get_by_label("Alignment of the trials").select_option("time")
        page.evaluate(fresh)
        there = page.evaluate(at.replace("S]", "0]") + ".toArray()")
        np.testing.assert_allclose(there, turned(walk(), 2.5, [1.0, -2.0]).q[60, :3], atol=0.02)


def test_measured_and_estimated_loads_look_different(page):
    page.locator("#scrub").fill("80")
    seen = "viewer.pressure.marks.map(({ measured, estimated }) => [measured.visible, estimated.visible])"
    right = page.evaluate(seen)[0]
    assert right == [True, False]
    page.get_by_label("Pressure, measured").uncheck()
    assert page.evaluate(seen)[0] == [False, False]
    assert page.locator(".contact.measured").count() > 2


def test_a_video_follows_the_time_of_the_trial_from_its_begin_on(opened, server):
    session = server.workspace.root / "P1"
    numbered_video(session / "walk2.webm", 2.0)
    numbered_video(session / "raw.avi", 0.2)
    with opened(server.url) as page:
        page.goto(f"http://127.0.0.1:{server.port}/trial/look?session=P1&trial=walk2")
        until(page, "Boolean(window.viewer && viewer.video && viewer.video.usable)")
        page.locator("#begins-s").fill("0.57")
        page.locator("#begins-s").press("Tab")
        until(
            page,
            "!viewer.video.saving.waiting && !viewer.video.saving.busy && viewer.video.saving.known.video[0]",
        )
        (kept,) = read_session(session / SESSION_FILE).trial("walk2").videos
        assert (kept.file, kept.begins_s) == ("walk2.webm", 0.57)
        page.evaluate("mbkf.seek(0.3)")
        assert page.evaluate("viewer.video.note.textContent") == "The video begins later."
        for time in (1.01, 1.94, 1.26):
            page.evaluate(f"mbkf.seek({time})")
            until(page, "!viewer.video.video.seeking")
            number = int((page.evaluate("mbkf.time") - 0.57) * VIDEO_HZ)
            until(page, f"({READ_NUMBER})() === {number}")
        page.evaluate("mbkf.play(true)")
        until(page, "mbkf.time > 1.5 && !viewer.video.video.paused")
        page.evaluate("mbkf.play(false)")
        assert page.evaluate("viewer.video.video.paused")
        assert page.evaluate("Math.abs(mbkf.time - 0.57 - viewer.video.video.currentTime)") < 1.0 / VIDEO_HZ
        page.locator("#video").select_option("raw.avi")
        until(page, "viewer.video.note.textContent.includes('raw.avi')")
        until(page, "viewer.video.saving.known.video[0].file === 'raw.avi'")
