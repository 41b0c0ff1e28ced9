"""A session of forty trials: memory and times of the page; a reload and a killed server in the middle of its run."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from time import perf_counter
from typing import Any

from benchmarks.app.path import same
from benchmarks.app.sessions import FORTY, forty
from benchmarks.app.visit import Server, Visit, until, visit
from benchmarks.checks import Check, information
from mbkf.io.session import SESSION_FILE
from mbkf.study.batch.run import batch

MEMORY_MB, LIST_S, PAINT_S = 300.0, 1.0, 2.0

NOTED = "Forty trials"

DRAWN = """() => {
  const viewer = window.mbkf && window.mbkf.view && window.mbkf.view.viewer;
  if (!viewer || !document.body.contains(viewer.renderer.domElement)) return false;
  viewer.render();  // pixels can be read in the task that draws them only
  const [canvas, n] = [document.createElement("canvas"), 64];
  canvas.width = canvas.height = n;
  const g = canvas.getContext("2d");
  g.drawImage(viewer.renderer.domElement, 0, 0, n, n);
  const red = g.getImageData(0, 0, n, n).data.filter((_, k) => k % 4 === 0);
  return Math.max(...red) - Math.min(...red) > 60;
}"""


def forty_rows(made: Any, out: Path, seed: int = 0) -> list[Check]:
    """Rows of the large session.

    Args:
        made: The browser.
        out: An empty folder.
        seed: Of the person and the walks.
    """
    session = forty(out / "lab", seed)
    server = Server(out / "lab")
    user = visit(made, server.url)
    cold = _listed(user)
    warm = _listed(user)
    user.page.locator("input[name=name]").fill(NOTED)
    user.page.locator("input[name=name]").press("Tab")
    user.page.wait_for_timeout(500)
    user.click("button.main")
    until(lambda: _done(user) >= 4)
    before = _done(user)
    user.page.reload()
    user.wait("progress")
    until(lambda: _done(user) > before)
    server.kill()
    server = Server(out / "lab")
    user = visit(made, server.url)
    user.wait("text=/Done in|Ended after/")
    results = sorted((out / "lab" / "results").rglob("summary.json"))
    alone = _undisturbed(session, out)
    unlike = sum(not same(path.parent, alone[k % 2]) for k, path in enumerate(results))
    paint = _painted(user)
    memory = _renderer_mb()
    stated = NOTED in (session / "session.toml").read_text(encoding="utf-8")
    server.stop()
    return [
        information("forty trials: list, the files never seen before", cold, "s"),
        Check("forty trials: list", warm, LIST_S, "<=", "s"),
        Check("forty trials: first paint of the 3-D view", paint, PAINT_S, "<=", "s"),
        Check("forty trials: memory of the page", memory, MEMORY_MB, "<=", "MB"),
        Check("reloaded, server killed in the run: results", len(results), float(FORTY), ">="),
        Check("reloaded, server killed in the run: results that differ", unlike, 0.0, "<="),
        Check("reloaded, server killed in the run: what was stated is there", float(stated), 1.0, ">="),
    ]


def _undisturbed(session: Path, out: Path) -> list[Path]:
    """Results of the two walks that all others are copies of, by a batch that nothing disturbs."""
    copy = out / "alone" / session.name
    copy.mkdir(parents=True)
    for name in ("static.c3d", "walk01.c3d", "walk02.c3d", SESSION_FILE):
        shutil.copy(session / name, copy)
    batch(copy.parent, out / "undisturbed")
    return [path.parent for path in sorted((out / "undisturbed").rglob("summary.json"))]


def _listed(user: Visit) -> float:
    """How long the list takes to be there after the page was asked for anew, s."""
    begin = perf_counter()
    user.page.reload()
    until(lambda: user.page.locator("tbody tr").count() >= FORTY)
    return perf_counter() - begin


def _done(user: Visit) -> int:
    """How many trials the page says are done."""
    found = re.match(r"(\d+) of \d+", user.page.locator(".run span").first.inner_text())
    return int(found[1]) if found else 0


def _painted(user: Visit) -> float:
    """From the click to the first picture of the body, s; a picture counts when its pixels are there."""
    begin = perf_counter()
    user.page.locator("td .buttons button").first.click()
    frame = user.page.locator("dialog iframe")
    frame.wait_for()
    view = frame.element_handle().content_frame()
    until(lambda: bool(view.evaluate(DRAWN)))
    return perf_counter() - begin


def _renderer_mb() -> float:
    """Memory of the largest page process of the browser (proportional set size), MB."""
    largest = 0.0
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if b"--type=renderer" not in (process / "cmdline").read_bytes():
                continue
            told = re.search(r"^Pss:\s+(\d+) kB", (process / "smaps_rollup").read_text(), re.M)
        except OSError:
            continue
        largest = max(largest, int(told[1]) / 1024.0 if told else 0.0)
    return largest
