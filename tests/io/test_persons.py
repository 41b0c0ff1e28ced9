"""Several persons in one capture: found by the names before their markers, one chosen, contact reported."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.capture import read_capture
from mbkf.io.persons import named_persons, one_person, persons_by_prefix, persons_by_shape
from mbkf.io.records import Capture, MarkerTrajectories
from tests.io.c3d_builder import build_c3d

OWN = [f"M{k}" for k in range(7)]
TWO = [f"{who}:{name}" for who in ("Anna", "Ben") for name in OWN]


def two(path, apart_mm=600.0):
    """Two persons, the second one beside the first, and a marker of the room."""
    points = np.random.default_rng(1).uniform(0.0, 400.0, (5, 7, 3))
    other = points + np.array([400.0 + apart_mm, 0.0, 0.0])
    room = np.zeros((5, 1, 3))
    return build_c3d(path, np.concatenate([points, other, room], axis=1), [*TWO, "room"])


def test_persons_carry_markers_of_the_same_names():
    assert list(persons_by_prefix(TWO)) == ["Anna", "Ben"]
    tool = [f"Anna:{name}" for name in OWN] + [f"Bat:{name}" for name in ("tip", "grip", "a", "b", "c", "d")]
    assert persons_by_prefix(tool) == {} and persons_by_prefix(OWN) == {}
    assert persons_by_prefix([*(f"Anna:{name}" for name in OWN), "Ball:M1", "Ball:M2"]) == {}
    assert persons_by_prefix([f"{side}:{name}" for side in ("L", "R") for name in OWN]) == {}


@pytest.mark.parametrize("choice", ["Ben", "2"])
def test_the_chosen_one_s_markers_stay_under_their_own_names(tmp_path, choice):
    file = two(tmp_path / "a.c3d")
    both, one = read_capture(file), read_capture(file, person=choice)
    assert "2 persons: Anna (7 markers), Ben (7 markers)" in both.notes[-1]
    assert one.markers.names == (*OWN, "room")
    np.testing.assert_array_equal(one.markers.positions_m[:, :7], both.markers.positions_m[:, 7:14])
    assert one.notes[-1].startswith("person Ben of 2; 7 markers")


def test_persons_who_come_near_may_touch(tmp_path):
    far = read_capture(two(tmp_path / "far.c3d"), person="Anna")
    near = read_capture(two(tmp_path / "near.c3d", apart_mm=-400.0 + 30.0), person="Anna")
    assert not any("contact" in note for note in far.notes)
    assert any("another person comes within 30 mm of M" in note for note in near.notes)


def test_a_mass_of_a_file_of_several_persons_could_be_anybody_s(tmp_path):
    capture = replace(read_capture(two(tmp_path / "a.c3d")), subject_mass_kg=70.0)
    found = one_person(capture, "Ben")
    assert found.subject_mass_kg is None and any("70.0 kg: it is not used" in note for note in found.notes)


@pytest.mark.parametrize("choice", ["Carl", "3", "0"])
def test_a_person_who_is_not_there_is_refused_with_those_who_are(tmp_path, choice):
    with pytest.raises(InvalidInput, match=r"its persons are Anna \(7 markers\), Ben"):
        read_capture(two(tmp_path / "a.c3d"), person=choice)
    with pytest.raises(InvalidInput, match=r"names and distances .* of one person"):
        read_capture(build_c3d(tmp_path / "b.c3d"), person=choice)


BONES = np.array([[0.1 * k, 0.05 * (k % 3), 0.15 * k] for k in range(12)])
"""Points of a figure: 1.65 m tall, 1.1 m wide."""


def figure(seed, place, frames=40):
    """(T, 12, 3) a figure whose points move by a few millimetres, somewhere."""
    moved = np.random.default_rng(seed).normal(0.0, 0.003, (frames, 1, 3)).cumsum(axis=0)
    return BONES[None] * [0.2, 1.0, 1.0] + moved + np.array(place)


def together(one_names, other_names, apart_m=1.0):
    """Two figures in one capture, columns of both in turn."""
    places = np.concatenate([figure(1, [0, 0, 0]), figure(2, [0, apart_m, 0])], axis=1)
    order = np.arange(24).reshape(2, 12).T.ravel()
    names = tuple(np.array([*one_names, *other_names])[order])
    return MarkerTrajectories(names, places[:, order], 100.0)


NAMES = ["LASI", "RASI", "C7", "LKNE", "RKNE", "STRN", "LTOE", "RTOE", "T10", "LSHO", "RSHO", "SACR"]


@pytest.mark.parametrize(
    ("one", "other", "called"),
    [
        ("{}", "{}_2", ["1", "2"]),
        ("{}_A", "{}_B", ["A", "B"]),
        ("P1-{}", "P2-{}", ["P1", "P2"]),
        ("{}", "{}b", ["1", "2"]),
    ],
)
@pytest.mark.parametrize("apart_m", [1.0, 0.4])
def test_persons_with_names_alike_are_told_apart_by_affixes(one, other, called, apart_m):
    """At 0.4 m the distances do not part the figures, and the names do."""
    both = together(map(one.format, NAMES), map(other.format, NAMES), apart_m)
    found = named_persons(both)
    assert [person.name for person in found] == called
    assert [list(person.own.values()) for person in found] == [NAMES, NAMES]
    assert [list(person.own) for person in found] == [
        [one.format(name) for name in NAMES],
        [other.format(name) for name in NAMES],
    ]


def test_persons_without_any_common_name_are_told_apart_by_distances():
    both = together(NAMES, [f"M{k}" for k in range(12)])
    assert named_persons(both) == ()
    first, second = persons_by_shape(both)
    assert list(first.own.values()) == NAMES and second.own["M3"] == "M3"
    chosen = one_person(Capture("a", both), "2")
    assert chosen.markers.names == tuple(second.own) and chosen.others.names == tuple(NAMES)
    np.testing.assert_array_equal(chosen.markers.positions_m, both.select(chosen.markers.names).positions_m)


def test_persons_with_names_alike_are_persons_beside_a_box_with_others():
    both = together([f"{name}_A" for name in NAMES], [f"{name}_B" for name in NAMES])
    corners = np.random.default_rng(3).uniform([0.0, 3.0, 0.0], [1.0, 4.0, 1.0], (1, 25, 3))
    markers = MarkerTrajectories(
        (*both.names, *(f"box{k}" for k in range(25))),
        np.concatenate([both.positions_m, np.repeat(corners, 40, axis=0)], axis=1),
        100.0,
    )
    assert [(one.name, list(one.own.values())) for one in named_persons(markers)] == [
        ("A", NAMES),
        ("B", NAMES),
    ]


def test_sides_and_numbers_of_one_body_are_no_persons():
    halves = np.concatenate([figure(1, [0, 0, 0]), figure(1, [0, 0.3, 0])], axis=1)
    for one, other in (("R{}", "L{}"), ("{}1", "{}2"), ("{}", "{}_2")):
        names = (*map(one.format, NAMES), *map(other.format, NAMES))
        assert named_persons(MarkerTrajectories(names, halves, 100.0)) == ()


def test_a_marker_with_another_s_affix_is_the_other_s_wherever_it_is():
    """A hand with a lost and found again marker."""
    both = together([f"{name}_A" for name in NAMES], [f"{name}_B" for name in NAMES])
    places = np.array(both.positions_m)
    places[:, both.names.index("RTOE_B")] = places[:, both.names.index("LASI_A")] + 0.02
    found = named_persons(replace(both, positions_m=places))
    assert [list(person.own.values()) for person in found] == [NAMES, NAMES]
