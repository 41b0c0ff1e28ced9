"""Takes the README's pictures of the live page and the report, with a synthetic walk in headless Chromium.

Run ``python -m benchmarks.screenshots FOLDER``.
"""

from __future__ import annotations

import io
import shutil
import sys
import tempfile
import threading
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from mbkf.cli.main import main as mbkf_command
from mbkf.io.capture import read_capture
from mbkf.io.results import Reconstruction
from mbkf.io.results_folder import read_reconstruction
from mbkf.io.subject import read_subject
from mbkf.io.verdict import Verdict
from mbkf.model.human import HumanModel
from mbkf.stream.results.frame import LiveFrame
from mbkf.stream.results.judgement import Judgement
from mbkf.trial.checks.orientation import laid
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.viz.live.page import LivePage

FLAGS = ("--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
SETTINGS = ReconstructSettings(smooth=False, correct_markers=False, other_contacts=False)
LIVE_S = 9.0
"""How long the stream runs before its picture is taken."""


def take(folder: Path, target: Path) -> None:
    """Takes the three pictures of a demo's folder."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=list(FLAGS))
        _live(browser, read_reconstruction(folder / "result"), target / "screenshot_live.png")
        _live_verdict(browser, _with_turned_plates(folder), target / "screenshot_live_verdict.png")
        page = browser.new_page(viewport={"width": 1180, "height": 900}, color_scheme="light")
        page.goto((folder / "report.html").absolute().as_uri())
        page.add_style_tag(content="nav { display: none !important }")
        _report(page, "quality", 0.0, 752.0, target / "screenshot_quality.png")
        _report(page, "motion", _top_of_cycles(page), 696.0, target / "screenshot_cycles.png")
        browser.close()


def _live(browser: Any, r: Reconstruction, target: Path) -> None:
    model = HumanModel.of(r.subject)
    live = LivePage(model, r.marker_names, r.plate_corners_m, title="walk, live")
    done = threading.Event()

    def feed() -> None:
        k = 0
        while not done.wait(1.0 / r.rate_hz):
            live.take(_frame(r, k))
            k += 1

    thread = threading.Thread(target=feed)
    thread.start()
    page = browser.new_page(viewport={"width": 1280, "height": 760})
    page.goto(live.url)
    low, high = page.locator(".card").first.locator("input").all()
    low.fill("10")
    high.fill("60")
    high.blur()
    page.wait_for_timeout(1e3 * LIVE_S)
    keep(page.screenshot(), target)
    page.close()
    done.set()
    thread.join()
    live.close()


def _live_verdict(browser: Any, r: Reconstruction, target: Path) -> None:
    """The top of the live page with the reasons of its verdict."""
    live = LivePage(HumanModel.of(r.subject), r.marker_names, r.plate_corners_m, title="walk, live")
    for k in range(2):
        live.take(_frame(r, k))
    page = browser.new_page(viewport={"width": 1280, "height": 760})
    page.goto(live.url)
    page.locator("#judgement summary").click()
    live.take(_frame(r, 2))
    page.wait_for_timeout(300)
    box = page.locator("#judgement").bounding_box()
    clip = {"x": 0, "y": 0, "width": 1280, "height": box["y"] + box["height"] + 150}
    keep(page.screenshot(clip=clip), target)
    page.close()
    live.close()


def _with_turned_plates(folder: Path) -> Reconstruction:
    """The demo's walk with all plates turned by 180°."""
    capture = read_capture(folder / "trial.c3d")
    turned = replace(capture, plates=tuple(laid(plate, 2, False) for plate in capture.plates))
    return reconstruct(turned, read_subject(folder / "subject.toml"), settings=SETTINGS)


def _frame(r: Reconstruction, k: int) -> LiveFrame:
    t = k % r.frames
    judgement = Judgement(r.verdict or Verdict(), 1.0)
    return LiveFrame(
        number=k, time_s=k / r.rate_hz, q=r.q[t], v=r.v[t], torques=r.tau[t], torques_sd=r.sd_tau[t],
        wrench=r.foot_wrench[t],
        wrench_sd=np.full((2, 6), np.nan) if r.foot_wrench_sd is None else r.foot_wrench_sd[t],
        plates=np.full((0, 6), np.nan), measured_m=r.measured_m[t], predicted_m=r.predicted_m[t],
        unlabelled_m=np.empty((0, 3)), angle_sd=r.angles_sd[t], angle_offset=0.0 * r.angles_sd[t],
        torques_offset=0.0 * r.sd_tau[t], wrench_offset=np.zeros((2, 6)), latency_s=float(r.step_seconds[t]), lost=0,
        rate_hz=r.rate_hz, tracked=bool(r.tracked[t]), started=k == 0, judgement=judgement,
    )  # fmt: skip


def _top_of_cycles(page: Any) -> float:
    heading = page.locator("#motion h3", has_text="Joint angles over").bounding_box()
    return float(heading["y"] - page.locator("#motion").bounding_box()["y"] - 12.0)


def _report(page: Any, section: str, top: float, height: float, target: Path) -> None:
    box = page.locator(f"#{section}").bounding_box()
    clip = {"x": box["x"] - 10, "y": box["y"] + top, "width": box["width"] + 20, "height": height}
    keep(page.screenshot(full_page=True, clip=clip), target)


def keep(png: bytes, target: Path) -> None:
    """Writes a picture as small as it goes without loss."""
    from PIL import Image

    Image.open(io.BytesIO(png)).convert("RGB").save(target, optimize=True)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        code = mbkf_command(["demo", "--motion", "walk", "--seed", "1", "--out", scratch])
        if code == 0:
            take(Path(scratch), Path(sys.argv[1]))
    sys.exit(code)
