"""Colours of segments: one for each, apart between neighbours and between the sides."""

from mbkf.model.body_file import load_body
from mbkf.viz.protocol.colours import HUES, segment_colours


def rgb(colour):
    return [int(colour[k : k + 2], 16) for k in (1, 3, 5)]


def apart(one, other):
    return sum((a - b) ** 2 for a, b in zip(rgb(one), rgb(other), strict=True)) ** 0.5


def test_neighbours_and_sides_are_told_apart():
    body = load_body("human18")
    colours = segment_colours(segment.name for segment in body.segments)
    assert len(set(colours.values())) == len(body.segments)
    for segment in body.segments:
        if segment.parent != "world":
            assert apart(colours[segment.name], colours[segment.parent]) > 60
    for name in HUES:
        if f"right_{name}" in colours:
            assert apart(colours[f"right_{name}"], colours[f"left_{name}"]) > 60
            assert sum(rgb(colours[f"left_{name}"])) > sum(rgb(colours[f"right_{name}"]))


def test_segments_called_otherwise_get_colours_too():
    colours = segment_colours(["trunk", "right_thigh", "box"])
    assert len(set(colours.values())) == 3
    assert colours["right_thigh"] == HUES["thigh"][0]
