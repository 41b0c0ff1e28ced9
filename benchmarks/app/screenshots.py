"""Takes the README's pictures of the laboratory's page: a session, its report, and two sessions compared.

Run ``python -m benchmarks.app.screenshots FOLDER``.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

from benchmarks.app.sessions import BAD, without_markers
from benchmarks.app.visit import Visit, browser, served, visit
from benchmarks.screenshots import keep
from benchmarks.session.change import MOTIONS, marked_anew, register_bent_walk
from mbkf.io.c3d_write import write_c3d
from mbkf.synthesis.person import synthesise_subject
from mbkf.trial.synth import synthesise

SESSIONS = ("Ana/1 before", "Ana/2 after")
TRIALS, SEED = 3, 3


def take(made: Any, lab: Path, target: Path) -> None:
    """Takes the pictures.

    Args:
        made: The browser.
        lab: A folder for the sessions.
        target: Where the pictures go.
    """
    _sessions(lab)
    with served(lab) as server:
        user = visit(made, server.url)
        for name in SESSIONS:
            user.click(f"button.session >> text={name}")
            user.wait(f"h2 >> text={name}")
            user.page.locator(".offer button").first.click()
            user.page.wait_for_timeout(500)
            user.click("button.main")
            user.wait("text=/Done in|Ended after/")
        user.page.set_viewport_size({"width": 1280, "height": 900})
        keep(user.page.screenshot(), target / "screenshot_app.png")
        user.click("button.marker-set")
        editor = user.page.frame_locator("dialog iframe")
        editor.locator(".item", has_text="RKNE").first.click()
        user.page.wait_for_timeout(1500)
        keep(user.page.locator("dialog").screenshot(), target / "screenshot_app_markers.png")
        user.click("dialog .bar button >> text=Close")
        user.page.get_by_role("row", name="walk1").get_by_role("button", name="3-D").click()
        user.page.wait_for_timeout(6000)
        keep(user.page.locator("dialog").screenshot(), target / "screenshot_app_look.png")
        user.click("dialog .bar button >> text=Close")
        user.click("#session-report")
        user.page.locator("dialog select").first.select_option(SESSIONS[0])
        user.page.wait_for_timeout(3000)
        _scrolled(user, "#gait-walk h3 >> nth=1", target / "screenshot_session_report.png")
        _scrolled(user, '#change svg[aria-label="Knee flexion, right"]', target / "screenshot_comparison.png")


def _sessions(lab: Path) -> None:
    """Before and after a change of the knees, and a file without markers."""
    register_bent_walk()
    person = synthesise_subject(SEED)
    for number, (name, motion) in enumerate(zip(SESSIONS, MOTIONS, strict=True)):
        folder = lab / name
        folder.mkdir(parents=True)
        who = marked_anew(person, SEED) if number else person
        for k in range(TRIALS):
            _, made = synthesise(motion, seconds=4.0, seed=10 * number + k, subject=who)
            write_c3d(made.trial, folder / f"walk{k + 1}.c3d")
        write_c3d(made.static, folder / "static.c3d")
        write_c3d(without_markers(made.trial), folder / BAD)


def _scrolled(user: Visit, selector: str, target: Path) -> None:
    user.page.frame_locator("dialog iframe").locator(selector).first.evaluate(
        "(e) => window.scrollTo(0, window.scrollY + e.getBoundingClientRect().top - 56)"
    )
    user.page.wait_for_timeout(800)
    keep(user.page.locator("dialog").screenshot(), target)


if __name__ == "__main__":
    scratch = Path(tempfile.mkdtemp(prefix="mbkf-"))
    with browser() as opened:
        take(opened, scratch / "study", Path(sys.argv[1]))
    shutil.rmtree(scratch)
