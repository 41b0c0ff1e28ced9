"""Several persons in one capture: found by the names before their markers, one chosen, contact reported."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.capture import read_capture
from mbkf.io.persons import check_one_person, one_person, persons_by_prefix
from mbkf.trial.scale import scale
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
    assert "Ben comes within 30 mm of Anna" in near.notes[-1]


def test_a_mass_of_a_file_of_several_persons_could_be_anybody_s(tmp_path):
    capture = replace(read_capture(two(tmp_path / "a.c3d")), subject_mass_kg=70.0)
    found = one_person(capture, "Ben")
    assert found.subject_mass_kg is None and "70.0 kg: it is not used" in found.notes[-1]


def test_a_body_of_two_persons_is_refused_with_their_names(tmp_path):
    both = read_capture(two(tmp_path / "a.c3d"))
    with pytest.raises(InvalidInput, match=r"2 persons: Anna .*--person NAME"):
        scale(both, mass_kg=70.0)
    check_one_person(one_person(both, "Anna"))


@pytest.mark.parametrize("choice", ["Carl", "3", "0"])
def test_a_person_who_is_not_there_is_refused_with_those_who_are(tmp_path, choice):
    with pytest.raises(InvalidInput, match=r"its persons are Anna \(7 markers\), Ben"):
        read_capture(two(tmp_path / "a.c3d"), person=choice)
    with pytest.raises(InvalidInput, match="those of one person"):
        read_capture(build_c3d(tmp_path / "b.c3d"), person=choice)
