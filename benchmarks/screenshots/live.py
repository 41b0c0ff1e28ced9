"""Pictures of the live page and of a trial's report, with the walk of ``mbkf demo``."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.app.visit import browser
from benchmarks.screenshots.picture import Taken, Taking
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

SETTINGS = ReconstructSettings(smooth=False, correct_markers=False, other_contacts=False)
SIZE = {"width": 1280, "height": 760}
LIVE_S = 8.0
"""Length of the stream, whose last frame the picture shows."""

FOLLOWS_MS = 1000.0
"""Time in which the view comes to rest beside the body; after 2 s the page says that no frames come."""


def live_pictures(scratch: Path) -> Taking:
    """Takes them.

    Args:
        scratch: An empty folder.
    """
    assert mbkf_command(["demo", "--motion", "walk", "--seed", "1", "--out", str(scratch)]) == 0
    with browser() as made:
        yield Taken("screenshot_live", _live(made, read_reconstruction(scratch / "result")))
        yield Taken("screenshot_live_verdict", _live_verdict(made, _with_turned_plates(scratch)))
        page = made.new_page(viewport={"width": 1180, "height": 900}, color_scheme="light")
        page.goto((scratch / "report.html").absolute().as_uri())
        page.add_style_tag(content="nav { display: none !important }")
        yield Taken("screenshot_quality", _part(page, "quality", 0.0, 752.0))
        yield Taken("screenshot_cycles", _part(page, "motion", _top_of_cycles(page), 696.0))


def _live(made: Any, r: Reconstruction) -> bytes:
    live = LivePage(HumanModel.of(r.subject), r.marker_names, r.plate_corners_m, title="walk, live")
    page = made.new_page(viewport=SIZE)
    page.goto(live.url)
    low, high = page.locator(".card").first.locator("input").all()
    low.fill("10")
    high.fill("60")
    high.blur()
    for k in range(round(LIVE_S * r.rate_hz)):
        live.take(_frame(r, k))
        time.sleep(1.0 / r.rate_hz)
    page.wait_for_timeout(FOLLOWS_MS)
    png: bytes = page.screenshot()
    page.close()
    live.close()
    return png


def _live_verdict(made: Any, r: Reconstruction) -> bytes:
    """The top of the live page with the reasons of its verdict."""
    live = LivePage(HumanModel.of(r.subject), r.marker_names, r.plate_corners_m, title="walk, live")
    for k in range(2):
        live.take(_frame(r, k))
    page = made.new_page(viewport=SIZE)
    page.goto(live.url)
    page.locator("#judgement summary").click()
    live.take(_frame(r, 2))
    page.wait_for_timeout(300.0)
    png: bytes = page.screenshot(clip={"x": 0, "y": 0, "width": SIZE["width"], "height": 480})
    page.close()
    live.close()
    return png


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


def _part(page: Any, section: str, top: float, height: float) -> bytes:
    box = page.locator(f"#{section}").bounding_box()
    clip = {"x": box["x"] - 10, "y": box["y"] + top, "width": box["width"] + 20, "height": height}
    png: bytes = page.screenshot(full_page=True, clip=clip)
    return png
