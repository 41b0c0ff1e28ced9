"""A plan: each trial in a place of its own, persons once, shards that make up the whole."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.errors import InvalidInput
from mbkf.study.batch.plan import (
    Files,
    Person,
    Plan,
    Sorted,
    Trial,
    folder_name,
    planned,
    scaling_candidates,
    trial_names,
)
from mbkf.study.scaling.rounds import MOST_TRIALS


def trials(count, persons=3):
    return [
        Trial(Person(f"P{k % persons}", "monday" if k % 2 else ""), Path(f"walk{k}.c3d"))
        for k in range(count)
    ]


@given(st.integers(1, 40), st.integers(1, 12))
def test_shards_make_up_the_whole_and_share_nothing(count, shards):
    plan = planned(trials(count), "here")
    parts = [plan.shard(k, shards).trials for k in range(1, shards + 1)]
    together = [trial for part in parts for trial in part]
    assert len(together) == len(set(together)) == count
    assert set(together) == set(plan.trials)
    assert max(map(len, parts)) - min(map(len, parts)) <= 1


@pytest.mark.parametrize("number, count", [(0, 3), (4, 3), (-1, 2), (1, 0)])
def test_a_shard_that_is_not_there_is_refused(number, count):
    with pytest.raises(InvalidInput, match=r"shard .* does not exist"):
        Plan(tuple(trials(3))).shard(number, count)


def test_persons_are_those_of_the_trials_once_each_and_in_order():
    plan = planned(trials(12), "here")
    assert [(p.name, p.session) for p in plan.persons] == [
        ("P0", ""), ("P1", "monday"), ("P2", ""), ("P0", "monday"), ("P1", ""), ("P2", "monday"),
    ]  # fmt: skip


def test_sorted_captures_have_their_persons_and_those_of_nobody_a_fault():
    one, two, three = (Path(f"walk{k}.c3d") for k in range(3))
    mixed, other = Person("P", unsorted=(Files(one), Files(two), Files(three))), Person("Q")
    plan = planned([*(Trial(mixed, path) for path in (one, two, three)), Trial(other, one)], "here")
    found = plan.with_persons({mixed: Sorted({one: Person("P-a"), two: Person("P-b")}, {three: "of nobody"})})
    assert [(t.person, t.fault) for t in found.trials] == [
        (Person("P-a"), ""), (Person("P-b"), ""), (Person("P"), "of nobody"), (other, ""),
    ]  # fmt: skip
    lost = plan.with_persons({mixed: "the worker was killed"})
    assert [t.fault for t in lost.trials] == [*["the worker was killed"] * 3, ""]


def test_trials_to_scale_from_do_not_depend_on_their_order():
    files = [Files(Path(f"{name}{k}.c3d")) for name in ("walk", "squat") for k in range(10)]
    found = scaling_candidates(files)
    assert found == scaling_candidates(files[::-1]) and len(found) == MOST_TRIALS
    assert [one.path.stem for one in found[:3]] == ["squat0", "walk0", "squat1"]


def test_trials_called_alike_are_named_with_their_folders():
    files = [Files(Path(name)) for name in ("a/walk.c3d", "b/walk.c3d", "b/squat.c3d")]
    assert list(trial_names(files)) == ["a/walk.c3d", "b/walk.c3d", "squat"]


def test_a_plan_from_standing_has_the_same_trials_of_persons_scaled_from_standing():
    plan = planned(trials(4), "here")
    assert all(person.static_only for person in plan.from_standing().persons)
    assert [one.place for one in plan.from_standing().trials] == [one.place for one in plan.trials]


def test_places_are_person_session_and_trial():
    one = Trial(Person("P1", "monday"), Path("a/walk.c3d"))
    assert one.place == Path("P1/monday/walk")
    assert Trial(Person("P1"), Path("a/walk.c3d"), name="first").place == Path("P1/first")


def test_two_files_in_one_place_are_refused_and_one_file_twice_is_one_trial():
    person = Person("P1")
    first, second = planned(
        [Trial(person, Path("a/walk.c3d")), Trial(person, Path("b/walk.c3d"))], "list.csv"
    ).trials
    assert not first.fault and "both be written to P1/walk; give one another name" in second.fault
    forced = Trial(person, Path("a/walk.c3d"), Path("a/walk.mot"))
    assert [bool(one.fault) for one in planned([Trial(person, Path("a/walk.c3d")), forced], "x").trials] == [
        False,
        True,
    ]
    once = planned([Trial(person, Path("a/walk.c3d"))] * 2, "list.csv")
    assert len(once.trials) == 1 and once.notes == ("list.csv: walk.c3d of P1 stands twice and is done once",)


def test_a_fault_takes_no_place_from_a_trial_and_its_person_is_not_scaled():
    lost, kept = Trial(Person("P1"), Path("a/walk.c3d"), fault="no"), Trial(Person("P1"), Path("b/walk.c3d"))
    plan = planned([lost, kept, Trial(Person("P2"), Path("c.c3d"), fault="no")], "list.csv")
    assert [one.fault for one in plan.trials] == ["no", "", "no"]
    assert plan.persons == (Person("P1"),)


@pytest.mark.parametrize("name", ["..", ".", "a/b", "a\\b", "a:b", "a\nb"])
def test_names_that_no_folder_can_have_are_refused(name):
    for trial in (
        Trial(Person(name), Path("walk.c3d")),
        Trial(Person("P1", name), Path("walk.c3d")),
        Trial(Person("P1"), Path("walk.c3d"), name=name),
    ):
        (found,) = planned([trial], "list.csv").trials
        assert "cannot be a folder's name" in found.fault
        assert not {".", ".."} & set(found.place.parts) and not found.place.is_absolute()


def test_a_plan_of_nothing_is_refused():
    with pytest.raises(InvalidInput, match="no trial was found"):
        planned([], "study")


@pytest.mark.parametrize(
    ("name", "folder"),
    [
        ("walk 1", "walk 1"),
        ("a<b>:c", "a_b__c"),
        ("..", "_.."),
        ("", "_"),
        ("ünïcode", "ünïcode"),
        ("a/b", "a_b"),
    ],
)
def test_names_of_files_become_names_of_folders(name, folder):
    assert (
        folder_name(name) == folder and planned([Trial(Person("P"), Path("a.c3d"), name=folder)], "x").trials
    )
