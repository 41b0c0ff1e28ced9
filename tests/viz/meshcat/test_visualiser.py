"""A person in MeshCat: nodes where forward kinematics has the segments, markers on them, drawn by a browser."""

import numpy as np
import pytest

import mbkf
from mbkf.errors import InvalidInput, ShapeError
from mbkf.viz.meshcat.visualiser import DISTANCE_M, FROM_M, BodyVisualiser, camera_place, show
from tests.recordings import walker
from tests.viz.browsing import until
from tests.viz.meshcat.recorded import path, viewer

DRAWN = """(() => {
  const found = [], note = (one) => { if (one.isMesh) found.push(one); };
  if (window.viewer) viewer.scene_tree.find(["meshcat", "human18"]).object.traverse(note);
  return found;
})()"""
"""Surfaces of the body and its markers in the page."""


@pytest.fixture(scope="module")
def person():
    return walker()[0]


@pytest.fixture(scope="module")
def model():
    return walker()[1]


@pytest.fixture
def q(model):
    return model.integrate(model.neutral(), np.random.default_rng(2).uniform(-0.5, 0.5, model.nv))


def node(name):
    return path("human18", "visuals", name)


def test_segments_and_markers_stand_where_forward_kinematics_has_them(person, model, q):
    shown = mbkf.show(person, q, open=False, viewer=viewer())
    placed = shown.viewer.window.transforms
    R, p = model.placements(q)
    for name, joint in model.joints.items():
        np.testing.assert_allclose(placed[node(name)][:3, :3], R[joint.joint_id], atol=1e-12)
        np.testing.assert_allclose(placed[node(name)][:3, 3], p[joint.joint_id], atol=1e-12)
    for marker in person.markers:
        joint = model.joint(marker.segment).joint_id
        place = p[joint] + R[joint] @ marker.position_m
        np.testing.assert_allclose(placed[node(f"marker_{marker.name}")][:3, 3], place, atol=1e-12)
    assert set(shown.viewer.window.objects) == set(placed)
    shown.display(model.neutral())
    np.testing.assert_array_equal(placed[node("pelvis")], np.eye(4))


def test_the_neutral_posture_stands_on_the_floor(model):
    shown = show(model, open=False, viewer=viewer())
    placed = shown.viewer.window.transforms
    lowest = [
        (placed[node(one.name)][:3, 3] + one.geometry.vertices())[:, 2].min()
        for one in shown.visual_model.geometryObjects
    ]
    assert min(lowest) == pytest.approx(0.0, abs=1e-12)
    assert not any(name.startswith("marker") for name in placed)


@pytest.mark.parametrize(
    ("bad", "error", "found"),
    [(np.zeros(3), ShapeError, r"\(3,\)"), (np.full(65, np.nan), InvalidInput, "NaN")],
)
def test_a_configuration_that_cannot_be_drawn_is_refused(model, bad, error, found):
    bad = bad if len(bad) == 3 else np.full(model.nq, np.nan)
    with pytest.raises(error, match=found):
        show(model, bad, open=False, viewer=viewer())


@pytest.mark.parametrize(
    ("notebook", "asked", "opens"), [(False, None, 1), (True, None, 0), (True, True, 1), (False, False, 0)]
)
def test_a_browser_opens_outside_notebooks_or_where_it_is_asked_for(
    model, monkeypatch, notebook, asked, opens
):
    shell = type("ZMQInteractiveShell", (), {})() if notebook else None
    monkeypatch.setattr("IPython.get_ipython", lambda: shell)
    assert show(model, open=asked, viewer=viewer()).viewer.window.opened == opens


@pytest.mark.parametrize("point", [(2.0, -1.0, 0.9), (-40.0, 9.0, 1.0), (0.0, 1.5, 0.4)])
def test_the_camera_sees_a_person_between_itself_and_the_origin(point):
    point, place = np.array(point), camera_place(np.array(point))
    assert np.linalg.norm(place[:2] - point[:2]) == pytest.approx(DISTANCE_M)
    np.testing.assert_allclose(np.cross([*place[:2], 0], [*point[:2], 0]), 0.0, atol=1e-12)
    towards = (place - point) / np.linalg.norm(place - point)
    assert towards @ place / np.linalg.norm(place) > np.cos(np.deg2rad(25))


def test_a_person_at_the_origin_is_seen_obliquely():
    np.testing.assert_array_equal(camera_place(np.array([0.1, 0.2, 0.9])), FROM_M)


@pytest.mark.slow
def test_a_browser_draws_the_body_and_a_notebook_frames_its_page(person, model, browser):
    shown = show(person, open=False)
    try:
        assert isinstance(shown, BodyVisualiser)
        assert f'src="{shown.viewer.url()}"' in shown._repr_html_()
        page = browser.new_page(device_scale_factor=0.25)
        page.goto(shown.viewer.url())
        until(page, f"{DRAWN}.length === {len(model.joints) + len(person.markers)}")
        until(page, "viewer.renderer.info.render.triangles > 20000")
        page.close()
    finally:
        shown.close()
    assert shown.viewer.window.server_proc.returncode is not None
