"""A protocol that was written is read as the same protocol."""

import json
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.errors import InvalidInput
from mbkf.model.body_file import load_body
from mbkf.model.protocol import KINDS, Protocol, ProtocolMarker, load_protocol, protocol_names
from mbkf.model.protocol_file import checked_name, protocol_text, write_protocol

LEGS = Path(__file__).resolve().parents[2] / "docs/examples/bodies/legs.toml"
BODY = load_body("human18")
SEGMENTS = [segment.name for segment in BODY.segments]

text = st.text(st.characters(exclude_categories=["Cs"]))
millimetres = st.floats(0.01, 500.0)


@st.composite
def markers(draw, name):
    if draw(st.booleans()):
        landmark = BODY.landmark(draw(st.sampled_from(sorted(BODY.landmarks))))
        segment, position, label = landmark.segment, landmark.position_m, landmark.name
    else:
        segment, label = draw(st.sampled_from(SEGMENTS)), ""
        position = np.array(draw(st.tuples(*3 * [st.floats(-2.0, 2.0)])))
    noise = draw(millimetres) / 1e3
    lasting = draw(st.sampled_from([0.0, noise]))
    return ProtocolMarker(
        name,
        segment,
        position,
        draw(st.sampled_from(KINDS)),
        draw(millimetres) / 1e3,
        noise,
        tuple(draw(st.lists(text, max_size=2))),
        draw(st.booleans()),
        label,
        draw(st.floats(0.0, 1.0)),
        tuple(draw(st.lists(st.tuples(st.sampled_from(SEGMENTS), st.floats(0.0, 1.0)), max_size=2))),
        lasting,
        draw(st.floats(0.0, 2.0)) if lasting else 0.0,
    )


@st.composite
def protocols(draw):
    names = draw(st.lists(text, max_size=4, unique=True))
    own = tuple(draw(markers(name)) for name in names)
    return Protocol(
        draw(text), draw(text), BODY, own, draw(text), draw(st.dictionaries(text, text, max_size=2))
    )


def assert_same(one, other):
    assert (one.name, one.title, one.source, dict(one.ignored)) == (
        other.name,
        other.title,
        other.source,
        dict(other.ignored),
    )
    assert (one.body.name, one.body.text) == (other.body.name, other.body.text)
    assert len(one.markers) == len(other.markers)
    for a, b in zip(one.markers, other.markers, strict=True):
        assert np.array_equal(a.position_m, b.position_m)
        assert replace(a, position_m=None) == replace(b, position_m=None)


@given(protocol=protocols())
def test_any_protocol_comes_back(protocol, tmp_path_factory):
    path = tmp_path_factory.getbasetemp() / "any.toml"
    write_protocol(protocol, path)
    assert_same(load_protocol(path), protocol)


@pytest.mark.parametrize("name", protocol_names())
def test_every_shipped_protocol_comes_back(name, tmp_path):
    write_protocol(load_protocol(name), tmp_path / "copy.toml")
    assert_same(load_protocol(tmp_path / "copy.toml"), load_protocol(name))


def test_a_body_of_ones_own_is_written_beside_it(tmp_path):
    protocol = load_protocol("reference36", load_body(LEGS))
    for _ in range(2):  # the second time the body is there already
        write_protocol(protocol, tmp_path / "legs.toml")
    assert_same(load_protocol(tmp_path / "legs.toml"), protocol)
    (tmp_path / "legs_body.toml").write_text("another", encoding="utf-8")
    with pytest.raises(InvalidInput, match="holds another body"):
        write_protocol(protocol, tmp_path / "legs.toml")


def test_a_place_wins_where_it_is_not_the_landmark(tmp_path):
    marker = replace(
        load_protocol("reference36").markers[0], landmark="c7", position_m=np.array([0.1, 0.2, 0.3])
    )
    protocol = Protocol("one", "One", BODY, (marker,))
    (entry,) = tomllib.loads(protocol_text(protocol))["marker"]
    assert entry["position_m"] == [0.1, 0.2, 0.3]
    assert "landmark" not in entry


@given(metres=st.floats(1e-6, 1.0))
def test_any_spread_comes_back_to_a_last_bit_or_two(metres):
    marker = replace(load_protocol("reference36").markers[0], placement_sd_m=metres, noise_m=metres)
    (entry,) = tomllib.loads(protocol_text(Protocol("one", "One", BODY, (marker,))))["marker"]
    assert entry["noise_mm"] / 1e3 == pytest.approx(metres, rel=4e-16)


def test_a_surrogate_that_no_file_can_hold_is_replaced():
    said = tomllib.loads(protocol_text(Protocol("a\udc80", "b\x7f", BODY, ())))
    assert (said["name"], said["title"]) == ("a?", "b\x7f")


@pytest.mark.parametrize("name", ["set.txt", "set", "folder.toml"])
def test_other_names_are_refused(name, tmp_path):
    (tmp_path / "folder.toml").mkdir()
    with pytest.raises(InvalidInput, match=json.dumps(name).strip('"')):
        checked_name(tmp_path / name)
