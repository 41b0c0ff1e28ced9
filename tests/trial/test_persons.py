"""Several persons in a capture: listed, refused without a choice, and no object taken for one."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.trial.info import describe
from mbkf.trial.persons import check_one_person, persons_in, summaries
from mbkf.trial.scale import scale
from tests.io.test_persons import NAMES, figure, together


def test_persons_by_name_are_listed_with_their_size_and_place():
    both = Capture("a", together([f"{name}_A" for name in NAMES], [f"{name}_B" for name in NAMES]))
    first, second = summaries(both, persons_in(both))
    assert (first.name, first.markers, second.name) == ("A", 12, "B")
    assert first.height_m == pytest.approx(1.65, abs=0.05)
    assert np.subtract(second.place_m, first.place_m) == pytest.approx([0.0, 1.0], abs=0.1)


def test_a_person_who_is_never_seen_has_no_place(tmp_path):
    both = together([f"A:{name}" for name in NAMES], [f"B:{name}" for name in NAMES])
    hidden = np.where([[[name.startswith("B")] for name in both.names]], np.nan, both.positions_m)
    found = describe(Capture("a", replace(both, positions_m=hidden)))
    assert [(one.name, one.place_m is None) for one in found.persons] == [("A", False), ("B", True)]
    assert found.protocol is None and "choose one with --person" in found.refusal


def test_a_box_beside_a_person_is_no_person():
    """Neither are scattered points, as the figures of these tests are."""
    box = np.random.default_rng(3).uniform(0.0, 1.0, (1, 12, 3)) + np.array([0.0, 2.0, 0.0])
    places = np.concatenate([figure(1, [0, 0, 0]), np.repeat(box, 40, axis=0)], axis=1)
    names = (*NAMES, *(f"box{k}" for k in range(12)))
    capture = Capture("a", MarkerTrajectories(names, places, 100.0))
    assert persons_in(capture) == ()
    check_one_person(capture)


def test_many_points_that_move_among_each_other_are_a_body():
    rng = np.random.default_rng(4)
    bends = rng.uniform(0.0, 1.0, (1, 22, 3)) + 0.2 * np.sin(np.arange(40))[:, None, None] * rng.normal(
        size=(22, 3)
    )
    places = np.concatenate(
        [0.4 * bends * [1, 1, 4], 0.4 * bends[::-1] * [1, 1, 4] + [0.0, 2.0, 0.0]], axis=1
    )
    capture = Capture("a", MarkerTrajectories(tuple(f"Q{k}" for k in range(44)), places, 100.0))
    assert [len(one.own) for one in persons_in(capture)] == [22, 22]


def test_a_file_with_every_name_twice_is_of_two_persons(real_data):
    path = real_data / "strangers3" / "two_persons_no_prefix.trc"
    with pytest.raises(
        InvalidInput, match=r"2 persons: 1 \(41 markers\), 2 \(41 markers\); choose one .*--person"
    ):
        scale(trials=[read_capture(path)], mass_kg=70.0)
    alone = read_capture(real_data / "strangers3" / "one_person_pig.trc").markers
    chosen = read_capture(path, person="1").markers
    assert chosen.names == alone.names == read_capture(path, person="2").markers.names
    np.testing.assert_allclose(chosen.positions_m, alone.positions_m, atol=1e-6)
