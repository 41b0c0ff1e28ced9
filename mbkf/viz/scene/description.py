"""The scene's static description: person, markers, plates."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.model.body import Body
from mbkf.model.body_shapes import as_plain as plain_shapes
from mbkf.model.body_shapes import segment_shapes
from mbkf.viz.scene.channels import STATUS, Layout, quantities
from mbkf.viz.sentences import in_languages
from mbkf.viz.wording import part_wording


def scene_description(
    title: str,
    model: Body,
    marker_names: tuple[str, ...],
    coordinate_names: tuple[str, ...],
    plate_corners_m: Array,
    layout: Layout,
    streamed: bool,
) -> dict[str, object]:
    """The page's first message, as JSON can hold it.

    Args:
        title: Name of the trial or subject.
        model: The body.
        marker_names: (M,) markers.
        coordinate_names: (A,) clinical coordinates.
        plate_corners_m: (K, 4, 3) corners of the plates; a plate with NaN is not drawn.
        layout: Of the rows that follow.
        streamed: True for rows of a stream.
    """
    drawn = plate_corners_m[np.isfinite(plate_corners_m).all(axis=(1, 2))]
    body = model.description
    own = {level.above: level.name for level in body.levels if level.position_m is None}
    own_levels = {joint.name: own[joint.distal] for joint in body.clinical_joints if joint.distal in own}
    plotted = quantities(layout, coordinate_names, body.clinical_joints, streamed, own_levels)
    return {
        "title": title,
        "weight_n": round(float(model.mass_kg * GRAVITY_M_S2), 1),
        "segments": plain_shapes(segment_shapes(model)),
        "markers": list(marker_names),
        "loads": [{"name": name, "side": part_wording(name).side} for name in layout.loads],
        "plates": np.round(drawn, 4).tolist(),
        "status": list(STATUS),
        "parts": {name: list(place) for name, place in layout.parts.items()},
        "width": layout.width,
        "quantities": [asdict(one) for one in plotted],
        "said": in_languages(
            text for one in plotted for text in (one.title, one.group, one.positive, one.unit)
        ),
    }
