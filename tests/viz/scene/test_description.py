"""What the page is told once."""

import json

import numpy as np

from mbkf.viz.scene.channels import Layout
from mbkf.viz.scene.description import scene_description
from tests.recordings import PLATE, walk, walker


def test_the_description_is_json_and_draws_only_plates_it_knows():
    r, model = walk(), walker()[1]
    layout = Layout(18, len(r.marker_names), len(r.coordinate_names))
    corners = np.array([PLATE, np.full((4, 3), np.nan)])
    scene = scene_description("A", model, r.marker_names, r.coordinate_names, corners, layout, streamed=True)
    assert json.loads(json.dumps(scene, allow_nan=False)) == scene
    assert scene["plates"] == [PLATE.tolist()]
    assert scene["markers"] == list(r.marker_names)
    assert scene["width"] == layout.width
    assert len(scene["segments"]) == 18
