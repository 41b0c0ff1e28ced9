"""Captures sorted by their movements: persons apart, one person whole, and no trial with another person's body."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from mbkf.errors import FileFormatError, InvalidInput
from mbkf.study.batch import sorting
from mbkf.study.batch.plan import Files, Person
from mbkf.study.batch.sorting import one_person, sorted_captures
from tests.bending import posed, squat, standing, walk

TALL, ANEW = {"factor": 1.1}, {"moved_m": 0.01}
CAPTURES = {
    "static1": standing,
    "static2": partial(posed, {}, **TALL),
    "static3": partial(posed, {}, **ANEW),
    "walk1": walk,
    "squat1": squat,
    "walk2": partial(walk, **TALL),
    "walk3": partial(walk, **ANEW),
}


OTHER = "_other"
BODIES = {}
"""Bodies by the markers that they were scaled from: many tests need one of them."""


def renamed(capture):
    """The capture in a marker set of other names."""
    names = tuple(f"{name}{OTHER}" for name in capture.markers.names)
    return replace(capture, markers=replace(capture.markers, names=names))


@pytest.fixture(autouse=True)
def scaled_once(monkeypatch):
    scale = sorting.scale

    def scaled(static, trials, **settings):
        capture = static or trials[0]
        names = capture.markers.names
        if names[0].endswith(OTHER):
            plain = tuple(name.removesuffix(OTHER) for name in names)
            found = scaled(
                None, [replace(capture, markers=replace(capture.markers, names=plain))], **settings
            )
            markers = tuple(replace(one, name=one.name + OTHER, aliases=()) for one in found.markers)
            return replace(found, markers=markers, covariance=None)
        key = capture.markers.positions_m.tobytes()
        if key not in BODIES:
            BODIES[key] = scale(static, trials, **settings)
        return BODIES[key]

    monkeypatch.setattr(sorting, "scale", scaled)


def read(path):
    if path.stem not in CAPTURES:
        raise FileFormatError(path, "is cut short")
    return CAPTURES[path.stem]()


def person(statics, trials, **known):
    moving = tuple(Files(Path(name)) for name in trials.split())
    return Person(
        "P", "", tuple(map(Path, statics.split())), moving, protocol="reference36", unsorted=moving, **known
    )


def told(found):
    """By name and session the standing trials and the trials; the reasons of the others."""
    owners = {}
    for path, one in found.persons.items():
        statics = " ".join(static.name for static in one.statics)
        owners.setdefault((one.name, one.session, statics), []).append(path.name)
    return owners, {path.name: reason for path, reason in found.faults.items()}


def test_each_trial_gets_the_standing_trial_that_it_fits():
    found = sorted_captures(person("static1 static2", "walk1 walk2 squat1", mass_kg=70.0), read)
    owners, faults = told(found)
    assert owners == {
        ("P-static1", "", "static1"): ["walk1", "squat1"], ("P-static2", "", "static2"): ["walk2"],
    } and not faults  # fmt: skip
    small = found.persons[Path("walk1")]
    assert [files.path.name for files in small.moving] == ["squat1", "walk1"]
    assert (
        small.mass_kg is None and "2 persons: static1 (walk1, squat1); static2 (walk2)" in small.remarks[-1]
    )
    assert "the mass in session.toml is not used" in small.remarks[-1]


def test_a_trial_that_fits_no_standing_trial_is_refused_with_numbers_and_a_remedy():
    owners, faults = told(sorted_captures(person("static1 static3", "walk1 walk2"), read))
    assert owners == {("P", "", "static1 static3"): ["walk1"]}
    assert "longer): another person, or markers put on anew; put it into a folder with" in faults["walk2"]


def test_two_standing_trials_of_one_person_leave_the_person_whole(monkeypatch):
    monkeypatch.setitem(CAPTURES, "static4", partial(posed, {}, moved_m=0.001))
    given = person("static1 static4", "walk1 squat1", mass_kg=70.0)
    found = sorted_captures(given, read)
    assert told(found) == ({("P", "", "static1 static4"): ["walk1", "squat1"]}, {})
    whole = found.persons[Path("walk1")]
    assert (whole.mass_kg, whole.remarks, whole.unsorted) == (70.0, (), ())


def test_markers_put_on_anew_are_another_session_of_the_person():
    found = sorted_captures(person("static1 static3", "walk1 walk3", mass_kg=70.0), read)
    assert told(found)[0] == {("P", "static1", "static1"): ["walk1"], ("P", "static3", "static3"): ["walk3"]}
    one = found.persons[Path("walk3")]
    assert (
        one.mass_kg == 70.0 and "put on anew between static1 (walk1) and static3 (walk3)" in one.remarks[-1]
    )


def test_a_trial_with_markers_put_on_anew_beside_one_standing_trial_is_a_remark(monkeypatch):
    monkeypatch.setitem(CAPTURES, "static4", partial(posed, {}, moved_m=0.001))
    found = sorted_captures(person("static1 static4", "walk1 walk3"), read)
    assert told(found)[0] == {("P", "", "static1 static4"): ["walk1", "walk3"]}
    assert "walk3: markers were put on anew" in found.persons[Path("walk1")].remarks[-1]


def test_standing_trials_without_such_names_are_found_and_stay_trials():
    owners, _ = told(sorted_captures(person("", "walk1 static1 walk2 static2"), read))
    assert owners == {
        ("P-static1", "", ""): ["walk1", "static1"],
        ("P-static2", "", ""): ["walk2", "static2"],
    }


def test_persons_without_standing_trials_are_known_by_their_movements():
    found = sorted_captures(person("", "walk1 walk2 squat1"), read)
    assert told(found)[0] == {("P-walk1", "", ""): ["walk1", "squat1"], ("P-walk2", "", ""): ["walk2"]}
    (remark,) = found.persons[Path("walk2")].remarks
    assert "put on anew" not in remark


def test_other_markers_than_those_of_the_standing_trial_are_another_person_s(monkeypatch):
    monkeypatch.setitem(CAPTURES, "walk4", lambda: renamed(walk()))
    monkeypatch.setitem(CAPTURES, "walk5", lambda: renamed(walk(**TALL)))
    owners, faults = told(sorted_captures(person("static1", "walk1 walk4 walk5"), read))
    assert owners == {
        ("P-static1", "", "static1"): ["walk1"], ("P-walk4", "", ""): ["walk4"], ("P-walk5", "", ""): ["walk5"],
    } and not faults  # fmt: skip


def test_a_capture_that_cannot_be_read_stays_with_one_person_and_fails_beside_two():
    owners, faults = told(sorted_captures(person("", "walk1 cut"), read))
    assert owners == {("P", "", ""): ["walk1", "cut"]} and not faults
    owners, faults = told(sorted_captures(person("", "walk1 walk2 cut"), read))
    assert "cut" in faults and "is cut short" in faults["cut"] and len(owners) == 2
    assert told(sorted_captures(person("", "cut"), read)) == ({("P", "", ""): ["cut"]}, {})


def test_captures_that_state_nothing_go_to_the_person_of_the_folder_whose_markers_they_show():
    host = Person("P1", "", (Path("static1"),), (), protocol="reference36")
    found = sorted_captures(person("static2", "squat1 walk2", hosts=(host,)), read)
    assert found.persons[Path("squat1")] is host
    assert found.persons[Path("walk2")].statics == (Path("static2"),)
    alone = sorted_captures(person("", "walk2", hosts=(host,)), read)
    assert not alone.persons and "from those in static1" in alone.faults[Path("walk2")]


def test_a_folder_of_two_persons_is_refused_where_one_is_asked_for(monkeypatch):
    monkeypatch.setattr(sorting, "read_capture", read)
    with pytest.raises(InvalidInput, match=r"2 persons: .*; put it into a folder"):
        one_person(person("", "walk1 walk2"))
    assert one_person(person("", "walk1 squat1")).unsorted == ()
