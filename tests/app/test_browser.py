"""The laboratory's page in a real browser: from the dropped folder to the report, whatever the files are called."""

import pytest

from mbkf.app.server import AppServer
from mbkf.io.session import read_session
from tests.studies import runs_here, study, walk_folder
from tests.viz.browsing import until
from tests.waiting import PATIENCE_S

NAME = "<img src=x onerror=window.hit=1>'{{words}}"


@pytest.fixture
def lab(tmp_path):
    with runs_here():
        server = AppServer(tmp_path / "lab", workers=1)
        yield server
        server.close()


@pytest.fixture
def page(opened, lab):
    with opened(lab.url) as found:
        found.set_viewport_size({"width": 1280, "height": 720})
        yield found


def test_a_dropped_folder_becomes_a_report(page, lab, tmp_path):
    source = study(tmp_path / "disk", trials=1) / "P1"
    (source / "session.toml").write_text("mass_kg = 120\n")
    page.locator("input[type=file]").first.set_input_files(source)
    page.wait_for_selector("tbody tr")
    assert page.locator(".problems", has_text="120.0 kg").count() == 1
    page.locator(".offer button").click()
    page.wait_for_selector(".problems", state="detached")
    assert read_session(lab.workspace.root / "P1" / "session.toml").mass_kg == pytest.approx(85.7, abs=0.5)
    page.locator("button.main").first.click()
    page.wait_for_selector("text=Done in", timeout=1e3 * PATIENCE_S)
    page.locator("#session-report").click()
    report = page.frame_locator("dialog iframe")
    report.locator("#gait-walk svg").first.wait_for()
    page.keyboard.press("Escape")
    page.locator("dialog").wait_for(state="detached")
    page.locator("#language select").select_option("es")
    page.wait_for_selector("text=Ensayos")
    page.locator("#session-report").click()
    report.locator("text=Potencias articulares").wait_for()


def test_all_sessions_run_while_the_page_is_loaded_again(page, lab):
    study(lab.workspace.root, persons=3, trials=1)
    (lab.workspace.root / "P2" / "walk1.c3d").unlink()
    page.reload()
    page.wait_for_selector("tbody tr")
    page.get_by_role("button", name="Run all sessions").click()
    page.wait_for_selector("#sessions progress")
    page.reload()
    page.wait_for_selector("text=Done in", timeout=1e3 * PATIENCE_S)
    page.locator("[data-key='session P3'] .verdict-use").wait_for()
    left_out = page.locator("#sessions li").nth(1)
    assert "left out" in left_out.inner_text() and "no moving trial" in left_out.inner_text()
    assert page.locator("td .status.done").count() == 1
    page.locator("#session-report").click()
    page.get_by_role("button", name="Next: P3").click()
    page.frame_locator("dialog iframe").locator("h1", has_text="P3").wait_for()
    assert page.get_by_role("button", name="Previous: P1").count() == 1


def test_names_are_text(page, lab):
    session = lab.workspace.root / NAME
    session.mkdir()
    (session / f"{NAME}.c3d").write_bytes((walk_folder() / "trial.c3d").read_bytes())
    page.reload()
    page.wait_for_selector("tbody tr")
    assert page.locator("tbody tr td b").first.inner_text() == f"{NAME}.c3d"
    page.wait_for_timeout(200)
    assert page.evaluate("window.hit") is None and page.locator("img").count() == 0


def test_a_file_that_cannot_be_kept_is_told_and_the_others_are_taken(page, opened, lab, tmp_path):
    folder = tmp_path / "P2"
    folder.mkdir()
    for name in ("walk.c3d", "walk?.c3d"):
        (folder / name).write_bytes((walk_folder() / "trial.c3d").read_bytes())
    page.locator("input[type=file]").first.set_input_files(folder)
    page.wait_for_selector("tbody tr")
    assert "1 files were refused" in page.locator("#told").inner_text()
    assert [path.name for path in (lab.workspace.root / "P2").iterdir()] == ["walk.c3d"]
    opened.errors[:] = [one for one in opened.errors if "400 (Bad Request)" not in one]  # the refusal itself


def test_a_message_stands_over_an_open_dialog(page):
    page.locator("#help button").click()
    page.locator("dialog[open]").wait_for()
    page.evaluate("tell('Not saved', true)")
    page.locator("#told .away").click()
    assert page.locator("#told").inner_text() == ""
    page.evaluate("tell('Not saved', true)")
    page.keyboard.press("Escape")
    page.locator("dialog").wait_for(state="detached")
    page.locator("#told .away").click()


def stops_at(page, key, most=80):
    """Presses Tab until a control has the focus, which is seen; returns the presses."""
    for presses in range(most):
        if page.evaluate("document.activeElement.dataset.key || ''").startswith(key):
            assert page.evaluate("getComputedStyle(document.activeElement).outlineStyle") != "none"
            return presses
        page.keyboard.press("Tab")
    raise AssertionError(f"{key} is not reached: {page.evaluate('document.activeElement.outerHTML')}")


def test_the_whole_job_by_keyboard(page, lab, tmp_path):
    source = study(tmp_path / "disk", trials=1) / "P1"
    (source / "broken.c3d").write_bytes(b"nothing")
    page.wait_for_selector(".drop")
    until(page, "document.querySelector('[data-key^=\"choose true\"]') !== null")
    stops_at(page, "choose true")
    with page.expect_file_chooser() as chosen:
        page.evaluate("0")  # an answer means that the browser has heard to hand its dialog over
        page.keyboard.press("Enter")
    chosen.value.set_files(source)
    page.wait_for_selector("tbody tr")
    content = {path.name: path.read_bytes() for path in (lab.workspace.root / "P1").iterdir()}
    stops_at(page, "run BUTTON main")
    page.keyboard.press("Enter")
    page.wait_for_selector(".running .bad:has-text('1 of 2 trials failed')", timeout=1e3 * PATIENCE_S)
    assert "1 of 2 trials failed" in page.text_content("#heard")
    badges = page.locator("button.session .status")
    assert (
        badges.count() == 2
        and page.locator("button.session .status.done, button.session .verdict-use").count() == 0
    )
    stops_at(page, "menu More for broken")
    page.keyboard.press("Enter")
    for _ in range(2):
        page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    page.wait_for_selector("#told:has-text('broken was deleted')")
    assert not (lab.workspace.root / "P1" / "broken.c3d").exists()
    assert page.evaluate("document.activeElement.textContent") == "Undo"
    page.keyboard.press("Enter")
    page.wait_for_selector("#told:has-text('broken is back')")
    assert page.evaluate("document.activeElement.dataset.key") == "menu More for broken"
    found = {path.name: path.read_bytes() for path in (lab.workspace.root / "P1").iterdir()}
    assert {name: found[name] for name in content} == content
    stops_at(page, "menu More for P1")
    page.keyboard.press("Enter")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    page.wait_for_selector("dialog input[name=name]")
    for name, reason in (("a?b", "not a possible name"), ("", "")):
        page.keyboard.press("Control+A")
        page.keyboard.type(name or "Q/visit 2")
        page.keyboard.press("Enter")
        page.wait_for_selector(
            f"dialog .wrong:has-text('{reason}')" if reason else "h2:has-text('Q/visit 2')"
        )
    page.keyboard.press("Escape")
    stops_at(page, "run BUTTON main 1")
    page.keyboard.press("Enter")
    page.frame_locator("dialog iframe").locator("#gait-walk svg").first.wait_for()
    page.keyboard.press("Escape")
    page.locator("dialog").wait_for(state="detached")
    until(page, "document.activeElement.id === 'session-report'")
