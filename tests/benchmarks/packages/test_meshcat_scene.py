"""The rows of MeshCat see a picture without a person, and are left out without a browser's driver."""

import io
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

from benchmarks.packages import meshcat_scene
from benchmarks.packages.meshcat_scene import HEIGHT, WIDTH, _covered, _off, meshcat_rows
from tests.recordings import walk, walker


def picture(dark_rows):
    pixels = np.full((HEIGHT, WIDTH), 245, np.uint8)
    pixels[dark_rows] = 120
    kept = io.BytesIO()
    Image.fromarray(pixels).save(kept, "PNG")
    return kept.getvalue()


def test_the_share_is_that_of_dark_pixels_below_the_menu():
    assert _covered(picture(slice(0, HEIGHT // 10))) == 0.0
    assert _covered(picture(slice(HEIGHT // 10, HEIGHT // 10 + 54))) == pytest.approx(0.1)


def test_a_segment_that_stands_elsewhere_is_seen():
    model = walker()[1]
    q = model.neutral()
    places = {name: model.placements(q)[1][joint.joint_id].tolist() for name, joint in model.joints.items()}
    page = SimpleNamespace(evaluate=lambda _, names: places[names[1]])
    assert _off(page, model, q) == 0.0
    places["left_hand"][1] += 0.002
    assert _off(page, model, q) == pytest.approx(0.002)


def test_without_playwright_the_rows_are_left_out(monkeypatch, tmp_path):
    monkeypatch.setattr(meshcat_scene, "installed", lambda module: False)
    (row,) = meshcat_rows(walk(), tmp_path)
    assert not row.bounded and "playwright" in row.note


@pytest.mark.slow
def test_a_browser_draws_person_and_result(tmp_path):
    rows = meshcat_rows(walk(), tmp_path)
    assert [row.name for row in rows if not row.passed] == []
    assert {path.name for path in tmp_path.iterdir()} == {"meshcat_person.png", "meshcat_result.png"}
