"""The page in a real browser: two pages of one session, and an address that never leads to another person."""

import shutil

import pytest

from mbkf.app.server import AppServer
from mbkf.io.session import read_session
from tests.studies import runs_here, study
from tests.viz.browsing import until
from tests.viz.conftest import forgotten


@pytest.fixture
def lab(tmp_path):
    study(tmp_path / "lab", persons=2, trials=1)
    with runs_here():
        server = AppServer(tmp_path / "lab", workers=1)
        yield server
        server.close()


@pytest.fixture(scope="module")
def tabs(browser):
    """Two pages of the same browser."""
    context = browser.new_context(viewport={"width": 1280, "height": 720}, locale="en")
    return [context.new_page() for _ in range(2)]


@pytest.fixture
def pages(tabs, lab):
    """Opens pages, at most two at a time; none may have reported an error but for a refused request."""
    free, troubles = list(tabs), []

    def note(error):
        troubles.append(str(error))

    def open_(query=""):
        page = free.pop()
        page.on("pageerror", note)
        if not page.context.cookies():
            page.goto(lab.url)
        page.goto(f"http://127.0.0.1:{lab.port}/{query}")
        page.wait_for_selector("#sessions button")
        return page

    yield open_
    for page in tabs:
        page.unroute_all()
        if page not in free:
            page.remove_listener("pageerror", note)
            forgotten(page)
    assert troubles == []


def shown(page, session):
    page.wait_for_selector(f"h2:has-text('{session}')")


def notes(lab, session="P1"):
    return read_session(lab.workspace.root / session / "session.toml")


def fill(page, name, value):
    with page.expect_response(lambda answer: answer.request.method == "POST"):
        page.fill(f"input[name={name}]", value)
        page.press(f"input[name={name}]", "Tab")


def test_two_pages_keep_each_other_s_edits(pages, lab):
    first, second = pages("?session=P1"), pages("?session=P1")
    for page in (first, second):
        shown(page, "P1")
    with first.expect_response(lambda answer: answer.request.method == "POST"):
        first.locator("tbody input[type=checkbox]").first.uncheck()
    fill(second, "mass_kg", "71.5")
    fill(first, "age", "30")
    found = notes(lab)
    assert (found.mass_kg, found.age) == (71.5, 30.0) and len(found.trials) == 1
    assert first.locator("dialog").count() == second.locator("dialog").count() == 0


@pytest.mark.parametrize(("choice", "kept"), [("mine", 80.0), ("theirs", 71.5)])
def test_a_field_that_two_pages_changed_is_chosen(pages, lab, choice, kept):
    first, second = pages("?session=P1"), pages("?session=P1")
    for page in (first, second):
        shown(page, "P1")
    fill(first, "mass_kg", "71.5")
    fill(second, "mass_kg", "80")
    form = second.locator("dialog form.differences")
    form.wait_for()
    assert "71.5" in form.inner_text() and "80" in form.inner_text() and notes(lab).mass_kg == 71.5
    form.locator(f"input[value={choice}]").check()
    form.locator("button").click()
    second.locator("dialog").wait_for(state="detached")
    until(second, f"document.querySelector('input[name=mass_kg]').value === '{kept:g}'")
    assert notes(lab).mass_kg == kept


def test_notes_are_not_asked_for_while_a_change_is_on_its_way(pages, lab):
    """Else an answer from before the change, which comes later, would be shown as the newer one."""
    page = pages("?session=P1")
    shown(page, "P1")
    order = []
    page.on("request", lambda request: order.append((request.method, "begins")))
    page.on("response", lambda answer: order.append((answer.request.method, "ends")))
    page.evaluate("act.person(shown, { mass_kg: 71.5 }); act.person(shown, { age: 30 }); refresh()")
    until(page, "document.querySelector('input[name=mass_kg]').value === '71.5'")
    until(page, "document.querySelector('input[name=age]').value === '30'")
    page.wait_for_load_state("networkidle")
    changes = [step for step in order if step[0] == "POST"]
    assert changes == [("POST", "begins"), ("POST", "ends")] * 2
    assert order[: len(changes)] == changes and ("GET", "begins") in order
    assert (notes(lab).mass_kg, notes(lab).age) == (71.5, 30.0)


def test_reload_back_and_forward_stay_with_their_session(pages):
    page = pages()
    shown(page, "P1")
    assert page.url.endswith("?session=P1")
    page.locator("button.session", has_text="P2").click()
    shown(page, "P2")
    page.reload()
    shown(page, "P2")
    page.go_back()
    shown(page, "P1")
    page.go_forward()
    shown(page, "P2")
    page.locator("button.marker-set").first.click()
    page.wait_for_selector("dialog iframe")
    assert "view=marker_set" in page.url and "session=P2" in page.url
    page.reload()
    page.wait_for_selector("dialog iframe[src*='session=P2']")
    page.locator("dialog button", has_text="Close").click()
    page.locator("dialog").wait_for(state="detached")
    assert page.url.endswith("?session=P2")
    page.locator("button.live").click()
    page.wait_for_selector("dialog.live")
    page.go_back()
    page.locator("dialog").wait_for(state="detached")
    shown(page, "P2")


@pytest.mark.parametrize("name", ["P9", "../P1", "photos"])
def test_an_unknown_session_is_not_another_person(pages, name):
    page = pages(f"?session={name}")
    page.wait_for_selector(".lack")
    assert name in page.locator(".lack").inner_text() and page.locator("h2").count() == 0
    assert page.locator("button.session[aria-current=true]").count() == 0


def test_a_damaged_or_removed_session_is_not_another_person(pages, lab):
    page, folder = pages("?session=P1"), lab.workspace.root / "P2"
    shown(page, "P1")
    (folder / "session.toml").write_text("mass_kg = [", encoding="utf-8")
    page.locator("button.session", has_text="P2").click()
    shown(page, "P2")
    assert "session.toml" in page.locator("main").inner_text() and page.locator("h2").count() == 1
    page.locator("button.session", has_text="P1").click()
    shown(page, "P1")
    shutil.rmtree(folder)
    page.locator("button.session", has_text="P2").click()
    page.wait_for_selector(".lack")
    assert page.locator("h2").count() == 0 and "P2" in page.locator(".lack").inner_text()


def test_a_folder_without_captures_says_so(pages, lab, tmp_path):
    photos = tmp_path / "photos"
    photos.mkdir()
    (photos / "one.jpg").write_bytes(b"\xff\xd8")
    page = pages("?session=P1")
    shown(page, "P1")
    page.locator("input[type=file]").first.set_input_files(photos)
    page.wait_for_selector(".lack")
    assert "photos" in page.locator(".lack").inner_text() and page.url.endswith("?session=photos")
    assert page.locator("h2").count() == 0


def test_late_replies_and_messages_end_with_their_session(pages):
    page, held = pages("?session=P1"), []
    shown(page, "P1")
    page.route("**/session?session=P1", lambda route: held.append(route))  # noqa: PLW0108
    page.evaluate("refresh(); act.person(shown, { age: 44 }); tell('a message of P1', true)")
    while len(held) < 2:
        page.wait_for_timeout(20)
    page.locator("button.session", has_text="P2").click()
    shown(page, "P2")
    assert page.locator("#told").inner_text() == ""
    for route in held:
        with page.expect_response("**/session?session=P1"):
            route.continue_()
    page.evaluate("new Promise((done) => setTimeout(done, 0))")
    assert page.locator("h2").inner_text() == "P2" and page.locator("#told").inner_text() == ""
    assert page.locator("input[name=age]").input_value() == ""
