"""The table of pictures: each once, with its size; and the command that takes them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

from benchmarks.screenshots.live import live_pictures
from benchmarks.screenshots.marker_sets import marker_set_pictures
from benchmarks.screenshots.page import page_pictures
from benchmarks.screenshots.picture import Taking, keep
from benchmarks.screenshots.verdict import verdict_picture

PICTURES: Mapping[str, tuple[int, int]] = {
    "screenshot_app": (1280, 1140),
    "screenshot_app_arrange": (1280, 720),
    "screenshot_app_bin": (1280, 720),
    "screenshot_app_folder": (1280, 720),
    "screenshot_app_look": (1230, 846),
    "screenshot_app_markers": (1230, 846),
    "screenshot_app_norms": (1230, 846),
    "screenshot_app_running": (1280, 900),
    "screenshot_app_video": (1230, 846),
    "screenshot_app_visit": (962, 380),
    "screenshot_comparison": (1230, 846),
    "screenshot_conditions": (1230, 846),
    "screenshot_cycles": (1144, 696),
    "screenshot_edit_set": (1200, 760),
    "screenshot_live": (1280, 760),
    "screenshot_live_verdict": (1280, 480),
    "screenshot_quality": (1144, 752),
    "screenshot_session_report": (1230, 846),
    "screenshot_show_set": (1200, 760),
    "screenshot_summary": (1478, 967),
    "screenshot_trend": (1124, 1252),
    "screenshot_trial_emg": (1230, 846),
    "screenshot_verdict": (1044, 992),
}
"""Width and height of each picture, px."""

FOLDER = Path(__file__).resolve().parents[1]
"""Folder of the pictures that README and docs show."""


def take(scratch: Path, target: Path, data: Path) -> Iterator[Path]:
    """Takes all pictures; yields the file of each.

    Args:
        scratch: An empty folder.
        target: Folder of the pictures.
        data: Folder of the shared captures.
    """
    for name, pictures in _groups(scratch, data).items():
        (scratch / name).mkdir(parents=True)
        for one in pictures:
            file = target / f"{one.name}.png"
            keep(one.png, file)
            yield file


def _groups(scratch: Path, data: Path) -> dict[str, Taking]:
    return {
        "live": live_pictures(scratch / "live"),
        "marker_sets": marker_set_pictures(scratch / "marker_sets", data),
        "page": page_pictures(scratch / "page"),
        "verdict": verdict_picture(scratch / "verdict"),
    }
