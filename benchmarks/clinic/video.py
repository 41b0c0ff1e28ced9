"""A video beside the 3-D view: its picture against the trial's time, byte ranges, refusal of a text file."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

from benchmarks.app.visit import Visit, browser, served, until, visit
from benchmarks.checks import Check, left_out
from benchmarks.clinic.made_video import READ_NUMBER, VIDEO_HZ, numbered_video
from benchmarks.clinic.words.pages import READ
from benchmarks.clinic.words.texts import decimal_points, english
from benchmarks.needs import installed
from mbkf.io.c3d_write import write_c3d
from mbkf.trial.synth import synthesise

SESSION, TRIAL = "S1", "m11"
SECONDS, VIDEO_S = 4.0, 5.0
BEGINS_S = {"m11.mp4": -0.37, "m11_2.webm": 0.58}
"""Videos, and the time of the trial at which each begins."""

TIMES_S = (0.6, 1.01, 1.94, 0.83, 3.2, 2.47)
"""Times of the trial at which it is paused; backwards, too."""

NO_VIDEO = "text.mp4"
RANGES = {"bytes=0-": (0, None), "bytes=100-199": (100, 200), "bytes=-7": (-7, None), "bytes=5-5": (5, 6)}
PLAYED_S = 0.5

_USABLE = "() => Boolean(window.viewer && viewer.video && viewer.video.usable)"
_FETCH = """async ([path, range]) => {
  const answer = await fetch(path, { headers: { Range: range } });
  return [answer.status, answer.headers.get("Content-Range"), [...new Uint8Array(await answer.arrayBuffer())]];
}"""


def video_rows(out: Path, seed: int = 0) -> Iterator[Check]:
    """All rows; the Spanish view is kept as a picture.

    Args:
        out: An empty folder.
        seed: Of the walk.
    """
    if not (installed("av") and installed("playwright")):
        yield left_out("video", "PyAV and playwright are missing: pip install '.[film]'")
        return
    lab = out / "lab"
    folder = _session(lab / SESSION, seed)
    with browser() as made, served(lab) as server:
        user = visit(made, server.url)
        user.wait("tbody tr")
        user.click("button.main")
        user.wait("text=/Done in|Ended/")
        address = server.url.split("?")[0]
        for name, begins_s in BEGINS_S.items():
            _look(user, address, "en", name)
            user.page.wait_for_function(_USABLE)
            yield from _followed(user.page, name, begins_s)
        yield from _ranges(user.page, folder)
        _look(user, address, "en", NO_VIDEO)
        user.page.wait_for_function("() => viewer.video.place.dataset.state === 'fault'")
        said = user.page.evaluate("viewer.video.note.textContent")
        yield Check("a text named as a video: refused with its name", float(NO_VIDEO in said), 1, ">=")
        yield from _spanish(user, address, out / "spanish.png")
        yield Check("errors in the page", len(user.troubles), 0, "<=")


def _session(folder: Path, seed: int) -> Path:
    folder.mkdir(parents=True)
    _, made = synthesise("walk", seconds=SECONDS, seed=seed)
    write_c3d(made.trial, folder / f"{TRIAL}.c3d")
    write_c3d(made.static, folder / "static.c3d")
    for name in BEGINS_S:
        numbered_video(folder / name, VIDEO_S)
    (folder / NO_VIDEO).write_text("no video\n" * 100, encoding="utf-8")
    return folder


def _look(user: Visit, address: str, language: str, name: str) -> None:
    """Opens the 3-D view and chooses a video."""
    words = urlencode({"session": SESSION, "trial": TRIAL, "language": language})
    user.page.goto(f"{address}trial/look?{words}")
    user.page.wait_for_function("() => Boolean(window.viewer && viewer.video)")
    user.page.locator("#video").select_option(name)


def _followed(page: Any, name: str, begins_s: float) -> Iterator[Check]:
    page.locator("#begins-s").fill(f"{begins_s:.2f}")
    page.locator("#begins-s").press("Tab")
    wrong = 0
    for time_s in TIMES_S:
        page.evaluate(f"mbkf.seek({time_s})")
        expected = int((page.evaluate("mbkf.time") - begins_s) * VIDEO_HZ)
        until(lambda: not page.evaluate("viewer.video.video.seeking"))
        page.wait_for_timeout(100.0)
        wrong += page.evaluate(READ_NUMBER) != expected
    yield Check(
        f"{name}, begins at {begins_s} s: pictures off at {len(TIMES_S)} times, paused", wrong, 0, "<="
    )
    page.evaluate("mbkf.seek(1.0), mbkf.play(true)")
    page.wait_for_function(f"() => mbkf.time > {1.0 + PLAYED_S} && !viewer.video.video.paused")
    page.evaluate("mbkf.play(false)")
    until(lambda: not page.evaluate("viewer.video.video.seeking"))
    page.wait_for_timeout(100.0)
    expected = int((page.evaluate("mbkf.time") - begins_s) * VIDEO_HZ)
    off = abs(page.evaluate(READ_NUMBER) - expected)
    yield Check(f"{name}: pictures off after it has played and was paused", off, 0, "<=")


def _ranges(page: Any, folder: Path) -> Iterator[Check]:
    wrong = 0
    for name in BEGINS_S:
        content = (folder / name).read_bytes()
        path = "video?" + urlencode({"session": SESSION, "file": name})
        for asked, (first, end) in RANGES.items():
            status, stated, given = page.evaluate(_FETCH, [path, asked])
            begin, stop, _ = slice(first, end).indices(len(content))
            right = (206, f"bytes {begin}-{stop - 1}/{len(content)}", content[begin:stop])
            wrong += (status, stated, bytes(given)) != right
    yield Check(f"ranges of bytes given wrong, of {len(BEGINS_S) * len(RANGES)}", wrong, 0, "<=")


def _spanish(user: Visit, address: str, picture: Path) -> Iterator[Check]:
    """Reads the texts of the Spanish view beside a video and beside a text file."""
    known = {*BEGINS_S, NO_VIDEO, TRIAL, SESSION, "mbkf"}
    texts: set[str] = set()
    for name in ("m11_2.webm", NO_VIDEO):
        _look(user, address, "es", name)
        user.page.wait_for_function("() => viewer.video.place.dataset.state !== 'waiting'")
        user.page.evaluate("mbkf.seek(0.1)")
        user.page.wait_for_timeout(300.0)
        texts |= set(user.page.evaluate(READ)["texts"])
        if name != NO_VIDEO:
            user.page.evaluate("mbkf.seek(2.0)")
            user.page.wait_for_timeout(1000.0)
            user.page.screenshot(path=str(picture))
    left = [text for text in texts if english(text, known) or (decimal_points(text) and text not in known)]
    (picture.parent / "words.txt").write_text("\n".join(left), encoding="utf-8")
    yield Check("Spanish view with a video: texts read", len(texts), 40, ">=")
    yield Check("Spanish view with a video: texts with English words or decimal points", len(left), 0, "<=")
