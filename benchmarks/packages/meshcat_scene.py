"""MeshCat: pixels and places of segments of a person and of a played result, in a headless browser."""

from __future__ import annotations

import io
import json
from pathlib import Path

import numpy as np

import mbkf
from benchmarks.checks import Check, left_out
from benchmarks.needs import installed
from mbkf.conventions import Array
from mbkf.io.results import Reconstruction
from mbkf.model.human import HumanModel
from mbkf.viz.film.browser import BrowserPage, shown_page
from mbkf.viz.meshcat.visualiser import BodyVisualiser

PLACES_M = 1e-5
"""Greatest distance of a segment from forward kinematics: MeshCat sends places in single precision."""

KEYS = 4
"""A frame that is a whole multiple of this is a key of the animation, not interpolated."""

LEAST_SHARE = 0.02
"""Least share of the picture that the person covers."""

LIGHT = 200
"""Darker pixels are of the person; floor and sky are lighter."""

WIDTH, HEIGHT = 900, 600
PATIENCE_MS = 60_000.0

DRAWN = """(body) => {
  let count = 0;
  const note = (one) => { count += one.isMesh ? 1 : 0; };
  if (window.viewer) viewer.scene_tree.find(["meshcat", body]).object.traverse(note);
  return count;
}"""
PLACE = """([body, name]) => viewer.scene_tree.find(["meshcat", body, "visuals", name]).object.position.toArray()"""


def meshcat_rows(result: Reconstruction, out: Path) -> list[Check]:
    """Rows of the result's person and of the result, each with its picture in the folder.

    Args:
        result: A result with markers and reactions.
        out: The folder.
    """
    if not installed("playwright"):
        return [
            left_out(
                "MeshCat: surfaces that a headless browser draws", "needs playwright: pip install '.[film]'"
            )
        ]
    k = result.frames // 2 // KEYS * KEYS
    model = HumanModel.of(result.subject)
    body, markers = len(model.joints), len(result.marker_names)
    arrows = sum(bool(np.isfinite(result.foot_cop_m[:, side]).any()) for side in (0, 1))
    person = mbkf.show(result.subject, result.q[k], open=False)
    played = mbkf.play(result, open=False)
    seek = f"viewer.animator.pause(); viewer.animator.seek({float(result.times_s[k] - result.times_s[0])!r})"
    try:
        return [
            *_rows("person", person, model, result.q[k], body + len(result.subject.markers), "", out),
            *_rows("result", played, model, result.q[k], body + markers + 2 * arrows, seek, out),
        ]
    finally:
        person.close()
        played.close()


def _rows(
    what: str, shown: BodyVisualiser, model: HumanModel, q: Array, count: int, then: str, out: Path
) -> list[Check]:
    """Surfaces in the page, segments' distance from forward kinematics, and share of the picture that is drawn.

    Args:
        what: Name of the rows.
        shown: The visualiser.
        model: Its body.
        q: (nq,) configuration that the page shows.
        count: Surfaces that it has.
        then: What the page does before it is looked at.
        out: Folder of the picture.
    """
    name = model.description.name
    with shown_page(shown.viewer.static_html(), WIDTH, HEIGHT) as page:
        page.wait_for_function(f"({DRAWN})({json.dumps(name)}) >= {count}", timeout=PATIENCE_MS)
        if then:
            page.wait_for_function("viewer.animator.duration > 0", timeout=PATIENCE_MS)
            page.evaluate(then)
        drawn = float(page.evaluate(DRAWN, name))
        off = _off(page, model, q)
        picture = page.screenshot()
    (out / f"meshcat_{what}.png").write_bytes(picture)
    return [
        Check(f"MeshCat, {what}: surfaces in the page of a headless browser", drawn, count, ">="),
        Check(f"MeshCat, {what}: segments off forward kinematics", off, PLACES_M, "<=", "m"),
        Check(f"MeshCat, {what}: share of the picture that is drawn", _covered(picture), LEAST_SHARE, ">="),
    ]


def _off(page: BrowserPage, model: HumanModel, q: Array) -> float:
    origins = model.placements(q)[1]
    places = {name: page.evaluate(PLACE, [model.description.name, name]) for name in model.joints}
    return max(
        float(np.abs(np.array(place) - origins[model.joint(name).joint_id]).max())
        for name, place in places.items()
    )


def _covered(picture: bytes) -> float:
    """Share of dark pixels below the viewer's own menu."""
    from PIL import Image

    grey = np.asarray(Image.open(io.BytesIO(picture)).convert("L"))[HEIGHT // 10 :]
    return float((grey < LIGHT).mean())
