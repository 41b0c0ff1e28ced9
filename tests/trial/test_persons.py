"""Several persons in a capture: listed, refused without a choice, and no object taken for one."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput, NotObservable
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


def walking(places):
    """The points of a person, 1 m forward over all frames, every other one swinging."""
    forward = np.linspace(0.0, 1.0, len(places))[:, None, None] * np.array([1.0, 0.0, 0.0])
    swing = 0.1 * np.sin(np.arange(len(places)))[:, None, None] * np.array([1.0, 0.0, 0.0])
    return places + forward + swing * (np.arange(places.shape[1]) % 2)[:, None]


def beside(others, rate_hz=25.0):
    """A walking person of 12 markers, and other points (T, N, 3) 2 m beside."""
    places = np.concatenate([walking(figure(1, [0, 0, 0])), others + np.array([0.0, 2.0, 0.0])], axis=1)
    names = (*NAMES, *(f"box{k}" for k in range(others.shape[1])))
    return Capture("a", MarkerTrajectories(names, places, rate_hz))


def box(noise_m=0.0):
    """(40, 12, 3) a box that stands, with noise of the cameras."""
    rng = np.random.default_rng(3)
    return rng.uniform(0.0, 1.0, (1, 12, 3)) + rng.normal(0.0, noise_m, (40, 12, 3))


def pushed(m, bent_m=0.0):
    """A box that is pushed so far, with a lid that opens by so much."""
    along = np.linspace(0.0, 1.0, 40)[:, None, None] * np.array([1.0, 0.0, 0.0])
    return box() + m * along + bent_m * along * (np.arange(12) < 4)[:, None]


def unmoved(capture):
    """A capture whose first frame lasts."""
    first = np.repeat(capture.markers.positions_m[:1], 40, axis=0)
    return replace(capture, markers=replace(capture.markers, positions_m=first))


def half_seen(capture):
    """A capture that shows the second body in two of five frames."""
    places = capture.markers.positions_m.copy()
    places[np.arange(40) % 5 > 1, 12:] = np.nan
    return replace(capture, markers=replace(capture.markers, positions_m=places))


@pytest.mark.parametrize(
    ("capture", "asked"),
    [
        (beside(box(0.0003)), 0),
        (beside(pushed(0.4, bent_m=0.008)), 0),
        (beside(box(0.0006)), 2),
        (beside(box(), rate_hz=50.0), 2),
        (beside(pushed(0.2)), 2),
        (beside(pushed(0.4, bent_m=0.02)), 2),
        (unmoved(beside(box())), 2),
        (half_seen(beside(box())), 2),
    ],
    ids=["stands", "pushed", "sways", "for a moment", "not far", "bends", "both stand", "seldom seen"],
)
def test_movement_shows_objects_before_a_body_is_sought(monkeypatch, capture, asked):
    """A search costs seconds: it is asked only of two bodies and more that may be persons."""
    sought = []

    def search(static, trials):
        sought.append(trials[0].markers.names)
        raise NotObservable("no body")

    monkeypatch.setattr("mbkf.trial.persons.infer_marker_set", search)
    assert persons_in(capture) == () and len(sought) == asked
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
