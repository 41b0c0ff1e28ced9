"""The page of a marker set: the body with the markers in the colours of their segments, and a list of them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from mbkf.conventions import Array
from mbkf.model.human import HumanModel
from mbkf.model.protocol import Protocol
from mbkf.model.segment_poses import segment_poses
from mbkf.trial.protocol.editing import SURE
from mbkf.trial.protocol.standing import Standing, faced_forward, neutral_on_floor
from mbkf.viz.page import asset, embedded, embedded_words, fill, viewer_script
from mbkf.viz.page import scripts as joined
from mbkf.viz.protocol.colours import segment_colours
from mbkf.viz.scene.channels import Layout
from mbkf.viz.scene.description import scene_description
from mbkf.viz.sentences import in_languages

SCRIPTS = ("element.js", "app_words.js", "colours.js", "scene.js", "marker_labels.js", "marker_set.js")
EDIT_SCRIPTS = (*SCRIPTS, "marker_edit.js")

UNKNOWN = "not in the set"
"""The page's text for a marker of the capture that the set neither has nor leaves out."""


def show_page(protocol: Protocol) -> str:
    """A self-contained page with a set on its reference body; it loads nothing and needs no server."""
    model = HumanModel.scaled(None, None, protocol.body)
    standing = Standing((), np.empty((0, 3)), model, neutral_on_floor(model), None)
    return page_text(set_data(protocol, standing), SCRIPTS, "'none'")


def page_text(data: dict[str, object], scripts: tuple[str, ...], connect: str) -> str:
    """The page as one piece of text.

    Args:
        data: Of :func:`set_data`, and for an editor its file and address.
        scripts: Names of its own scripts, in the order they are needed.
        connect: Addresses that it may connect to, as in a content security policy.
    """
    return fill(
        "marker_set.html",
        connect=connect,
        style=asset("page.css") + asset("marker_set.css"),
        data=embedded("set", data | {"said": in_languages(_texts(data))}),
        words=embedded_words("viewer", "marker_set_page"),
        meshcat=viewer_script(),
        scripts=joined(scripts),
    )


def set_data(protocol: Protocol, standing: Standing) -> dict[str, object]:
    """The set and the body, as JSON can hold them.

    Args:
        protocol: The marker set.
        standing: The capture, with the body beside it; without a point for a set by itself.
    """
    standing = faced_forward(standing)
    model, body = standing.model, protocol.body
    layout = Layout(len(model.joints), 0, 0)
    row = layout.blank(1)
    layout.put(row, "segments", segment_poses(model, standing.q[None]))
    colours = segment_colours(model.joints)
    scene = scene_description(protocol.title, model, (), (), np.empty((0, 4, 3)), layout, streamed=False)
    return {
        "name": protocol.name,
        "title": protocol.title,
        "source": protocol.source,
        "body": body.name,
        "sure": SURE,
        "captured": bool(standing.names),
        "scene": {**scene, "quantities": []},
        "row": [None if np.isnan(value) else round(float(value), 5) for value in row[0]],
        "segments": [
            {"name": name, "title": name.replace("_", " "), "colour": colours[name]} for name in model.joints
        ],
        "landmarks": [
            {
                "name": one.name,
                "segment": one.segment,
                "at": _plain(standing.to_world(one.segment, one.position_m)),
            }
            for one in body.landmarks.values()
        ],
        "markers": _markers(protocol, standing),
    }


def _markers(protocol: Protocol, standing: Standing) -> list[dict[str, object]]:
    """Every marker of the set and of the capture: its place in the capture, and its place in the set."""
    match = protocol.match(standing.names)
    names = {marker.name: name for name, marker in match.items()}
    points = dict(zip(standing.names, standing.points_m, strict=True))
    found: list[dict[str, object]] = []
    for marker in protocol.markers:
        name = names.get(marker.name, marker.name)
        place = standing.to_world(marker.segment, marker.position_m)
        found.append(
            {
                "name": name,
                "segment": marker.segment,
                "landmark": marker.landmark,
                "kind": marker.kind,
                "probability": marker.probability,
                "alternatives": [list(one) for one in marker.alternatives],
                "ignored": "",
                "at": _plain(points.get(name, place)),
                "place": _plain(place),
                "seen": name in points,
            }
        )
    ignored = {**dict.fromkeys((n for n in standing.names if n not in match), UNKNOWN), **protocol.ignored}
    shown = {str(one["name"]) for one in found}
    for name, reason in ignored.items():
        if name not in shown:
            at = _plain(points[name]) if name in points else None
            found.append(
                {
                    "name": name, "segment": "", "landmark": "", "kind": "", "probability": 1.0, "alternatives": [],
                    "ignored": reason or "left out", "at": at, "place": None, "seen": name in points,
                }
            )  # fmt: skip
    return found


def _texts(data: object) -> Iterator[str]:
    """All texts of the page's data; names of landmarks as they are read."""
    if isinstance(data, str):
        yield data.replace("_", " ")
    elif isinstance(data, dict):
        for one in data.values():
            yield from _texts(one)
    elif isinstance(data, list | tuple):
        for one in data:
            yield from _texts(one)


def _plain(point_m: Array) -> list[float]:
    return [round(float(x), 4) for x in point_m]
