"""The page in a browser: a new user's clicks, the keyboard alone, narrow screens, failures, undo and accessibility.

The benchmark writes a folder with a standing trial, a walk and a text file named as a capture; the text file fails,
so the page must not show the session in green.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

from benchmarks.app.accessible import findings
from benchmarks.app.pages_of import every_page
from benchmarks.app.visit import SIZE, Visit, browser, served, until, visit
from benchmarks.checks import Check
from mbkf.io.c3d_write import write_c3d
from mbkf.trial.synth import synthesise

SIZES = {"800 px": 800, "200 % of 1280 px": 640}
"""Widths of the window, CSS pixels."""

HEIGHT, SECONDS, CLICKS, MOST_TABS = 720, 4.0, 6, 120

GREEN = "button.session .status.done, button.session .verdict-use"
"""A session in the list that looks as if every trial may be used."""

ENDED = ".running span:has-text('Ended'), .running span:has-text('Done in')"

BROKEN = "broken"

REHEARSED, REHEARSED_S = "rehearsed", 40.0
"""A capture that is replayed live; it is added after the calculation."""


def page_rows(out: Path, seed: int = 0) -> Iterator[Check]:
    """Rows of all.

    Args:
        out: Folder for the files.
        seed: Of the walk.
    """
    shutil.rmtree(out, ignore_errors=True)
    source, lab = _session(out / "disk" / "Ana", seed), out / "lab"
    with browser() as made, served(lab) as server:
        user = visit(made, server.url)
        user.wait(".drop")
        yield from _accessible(user, "nothing dropped")
        user.choose_folder(source)
        user.wait("tbody tr")
        user.click("button.main")
        user.wait(".under-way progress")
        yield _serious(user, "session that is calculated")
        shares = _shares(user)
        yield Check("a share of frames is seen inside a trial; different shares", len(shares), 2, ">=")
        yield Check("failed trial: the session looks green", user.page.locator(GREEN).count(), 0, "<=")
        user.click("#session-report")
        user.page.frame_locator("dialog iframe").locator("#gait-walk svg").first.wait_for()
        yield Check("new user, one session: clicks from folder to report", user.clicks, CLICKS, "<=")
        user.page.keyboard.press("Escape")
        user.page.locator("dialog").wait_for(state="detached")
        yield from _live(user, lab / "Ana", seed)
        yield from _undone(user, lab)
        yield from _pages(user)
        yield Check("errors in the page", len(user.troubles), 0, "<=")
    yield from _by_keyboard(source, out / "keyboard")


def _session(folder: Path, seed: int) -> Path:
    folder.mkdir(parents=True)
    _, made = synthesise("walk", seconds=SECONDS, seed=seed)
    write_c3d(made.trial, folder / "walk.c3d")
    write_c3d(made.static, folder / "static.c3d")
    (folder / f"{BROKEN}.c3d").write_bytes(b"nothing")
    return folder


def _shares(user: Visit) -> set[float]:
    """The shares that the bar of a trial shows until the run ends."""
    found: set[float] = set()

    def ended() -> bool:
        bars = "[...document.querySelectorAll('.under-way progress')].map((one) => one.value)"
        found.update(value for value in user.page.evaluate(bars) if 0.0 < value < 1.0)
        return bool(user.page.locator(ENDED).count())

    until(ended)
    return found


def _accessible(user: Visit, name: str) -> Iterator[Check]:
    for size, width in {"": SIZE["width"], **SIZES}.items():
        user.page.set_viewport_size({"width": width, "height": HEIGHT if size else SIZE["height"]})
        user.page.wait_for_timeout(300.0)
        frames = user.page.frames
        if not size:
            yield _serious(user, name)
            continue
        wide = max(frame.evaluate("document.documentElement.scrollWidth - innerWidth") for frame in frames)
        yield Check(f"{size}, {name}: width beyond the window, px", wide, 0, "<=")
    user.page.set_viewport_size(SIZE)


def _serious(user: Visit, name: str) -> Check:
    serious = sum(len(findings(frame)) for frame in user.page.frames)
    return Check(f"axe-core, {name}: serious or critical findings", serious, 0, "<=")


def _live(user: Visit, session: Path, seed: int) -> Iterator[Check]:
    """A live run that replays a capture, while its page is connected."""
    _, lasting = synthesise("squat", seconds=REHEARSED_S, rate_hz=50.0, seed=seed)
    write_c3d(lasting.trial, session / f"{REHEARSED}.c3d")
    user.page.reload()
    user.wait("tbody tr")
    user.page.locator("button.live").click()
    user.page.select_option("select[name=source]", "file")
    user.page.select_option("select[name=trial]", REHEARSED)
    user.page.locator("dialog button.main").click()
    live = user.page.frame_locator("dialog iframe").frame_locator("iframe")
    live.locator("#state", has_text="live").wait_for()
    yield _serious(user, "live page that is connected")
    user.page.locator("dialog .stop").click()
    user.page.locator("dialog .told", has_text="Recorded as").wait_for()
    user.page.keyboard.press("Escape")
    user.page.locator("dialog").wait_for(state="detached")


def _pages(user: Visit) -> Iterator[Check]:
    for name, _ in every_page(user):
        yield from _accessible(user, name)
    user.click("#help button")
    user.page.frame_locator("dialog iframe").locator("#add").wait_for()
    yield from _accessible(user, "help")
    user.page.keyboard.press("Escape")
    user.page.locator("dialog").wait_for(state="detached")


def _undone(user: Visit, lab: Path) -> Iterator[Check]:
    """Deletes, renames and moves, and undoes each; counts files that are not as before."""
    before = _files(lab)
    for number, act in enumerate(("Delete", "Rename or move")):
        for owner in ("walk", "Ana"):
            user.page.locator(f"[data-key='menu More for {owner}']").click()
            user.page.locator("details[open] button", has_text=act).click()
            if number:
                user.page.locator("dialog input[name=name]").fill(f"{owner} ä")
                user.page.locator("dialog button.main").click()
            user.page.locator("#told button", has_text="Undo").click()
            user.page.locator("#told", has_text="is back").wait_for()
    after = _files(lab)
    lost = {name for name in before if after.get(name) != before[name]}
    yield Check("deleted, renamed and undone: files that differ", len(lost), 0, "<=")


def _files(lab: Path) -> dict[str, bytes]:
    named = {path.relative_to(lab).as_posix(): path for path in lab.rglob("*") if path.is_file()}
    return {
        name: path.read_bytes()
        for name, path in named.items()
        if not name.startswith(".") and not name.endswith("runs.json")
    }


def _by_keyboard(source: Path, lab: Path) -> Iterator[Check]:
    """From the folder to the report without a pointer; each control must show its focus."""
    with browser() as made, served(lab) as server:
        user = visit(made, server.url)
        user.wait(".drop")
        hidden = _press(user, "choose true", choose=source)
        user.wait("tbody tr")
        hidden += _press(user, "run BUTTON main 0")
        user.wait(ENDED)
        hidden += _press(user, "run BUTTON main 1")
        report = user.page.frame_locator("dialog iframe")
        report.locator("#gait-walk svg").first.wait_for()
        yield Check(
            "keyboard alone: folder to report", float(report.locator("#gait-walk svg").count() > 0), 1, ">="
        )
        yield Check("keyboard alone: stops without a visible focus", hidden, 0, "<=")


def _press(user: Visit, key: str, choose: Path | None = None) -> int:
    """Goes to a control by Tab and presses it; returns the stops on the way that show no focus."""
    hidden = 0
    for _ in range(MOST_TABS):
        found, outline = user.page.evaluate(
            "(() => { const one = document.activeElement; return [one.dataset.key || '',"
            " one === document.body || getComputedStyle(one).outlineStyle !== 'none']; })()"
        )
        hidden += not outline
        if found == key:
            break
        user.page.keyboard.press("Tab")
    if choose is None:
        user.page.keyboard.press("Enter")
    else:
        with user.page.expect_file_chooser() as chooser:
            user.page.evaluate("0")  # an answer means that the browser has heard to hand its dialog over
            user.page.keyboard.press("Enter")
        chooser.value.set_files(choose)
    return hidden
