"""A listing gathers persons over several rows; contradictions and lost rows cost their own trials."""

from pathlib import Path

import pytest

from mbkf.errors import FileFormatError, InvalidInput
from mbkf.study.batch.listing import Listing
from mbkf.study.batch.plan import Files
from mbkf.study.scaling.rounds import MOST_TRIALS

A, B = ("A", ""), ("B", "monday")


@pytest.fixture
def listing():
    return Listing(Path("list.csv"))


def add(listing, key, *names, **stated):
    listing.person(key, stated, 2)
    for name in names:
        listing.trial(key, Files(Path(name)), Path(name).stem)


def test_statements_of_all_rows_hold_for_all_trials_of_the_person(listing):
    add(listing, A, "a.c3d")
    add(listing, B, "b.c3d")
    add(listing, A, "c.c3d", mass_kg=70.0)
    add(listing, A, mass_kg=70.0, height_m=1.8)
    listing.static(A, Path("s.c3d"))
    listing.static(A, Path("s.c3d"))
    first, second, third = listing.plan().trials
    assert first.person == third.person and second.person.session == "monday"
    assert (first.person.mass_kg, first.person.height_m, first.person.statics) == (
        70.0,
        1.8,
        (Path("s.c3d"),),
    )
    assert [files.path.name for files in first.person.moving] == ["a.c3d", "c.c3d"]


def test_a_contradiction_costs_the_person_and_names_both_lines(listing):
    add(listing, A, "a.c3d", mass_kg=70.0)
    add(listing, B, "b.c3d", mass_kg=70.0)
    listing.person(A, {"mass_kg": 80.0}, 7)
    lost, kept = listing.plan().trials
    assert lost.fault == "list.csv, line 7: mass_kg of A is 80.0 here and 70.0 in line 2; keep one of both"
    assert not kept.fault


def test_lost_trials_keep_their_order_and_are_no_part_of_scaling(listing):
    listing.lose(A, "x", Path("x.c3d"), FileFormatError("list.csv", "no", 3))
    add(listing, A, *(f"{n}.c3d" for n in range(MOST_TRIALS + 1)))
    lost, *kept = listing.plan().trials
    assert (lost.name, lost.fault) == ("x", "list.csv, line 3: no")
    assert len(kept) == MOST_TRIALS + 1 and len(kept[0].person.moving) == MOST_TRIALS


def test_a_lost_person_loses_all_trials(listing):
    add(listing, A, "a.c3d", "b.c3d")
    listing.lose_person(A, FileFormatError("list.csv", "no"))
    assert [trial.fault for trial in listing.plan().trials] == ["list.csv: no"] * 2


def test_a_listing_of_nothing_is_refused(listing):
    with pytest.raises(InvalidInput, match="no trial"):
        listing.plan()
