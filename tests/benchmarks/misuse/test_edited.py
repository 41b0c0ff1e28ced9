"""Every listed mistake of people ends rightly, and the benchmark tells a wrong end from a right one."""

from dataclasses import replace

import pytest

from benchmarks.misuse.edited import BOUND, Mistake, end_of, mistakes

LISTED = mistakes()


def test_there_are_enough_and_each_once():
    assert len(LISTED) >= BOUND and len(set(LISTED)) == len(LISTED)
    assert all(bool(one.refused) != bool(one.read) for one in LISTED)


@pytest.mark.parametrize("mistake", LISTED, ids=[f"{one.file}-{n}" for n, one in enumerate(LISTED)])
def test_a_mistake_is_refused_by_name_or_read_as_meant(mistake, tmp_path):
    end = end_of(mistake, tmp_path / "file")
    assert end.verdict == "right", f"{mistake.new!r}: {end.found}"


MASS = "mass_kg = 71.2"


@pytest.mark.parametrize(
    ("mistake", "verdict"),
    [
        (Mistake("session", MASS, "mass_kg = 72", refused=("mass_kg",)), "ignored"),
        (Mistake("session", MASS, "mass_kg = 72", read="mass_kg=71.2"), "misread"),
        (Mistake("session", MASS, "mass = 72", read="mass_kg=72.0"), "misread"),
        (Mistake("session", MASS, "mass = 72", refused=("height_m",)), "without the right words"),
        (
            Mistake("list.csv", "P09,w9.c3d,,80", "P09,w9.c3d,,heavy", refused=("heavy",), lost="P01"),
            "spread",
        ),
        (Mistake("session", "nowhere", "x", refused=("x",)), "unforeseen"),
    ],
)
def test_wrong_ends_are_told_apart(mistake, verdict, tmp_path):
    assert end_of(mistake, tmp_path / "file").verdict == verdict


def test_an_unedited_sample_of_each_kind_is_read(tmp_path):
    for n, kind in enumerate({one.file for one in LISTED}):
        same = replace(next(one for one in LISTED if one.file == kind), refused=(), read="?")
        end = end_of(replace(same, new=same.old, encoding="utf-8"), tmp_path / str(n))
        assert end.verdict == "misread" and "Error" not in end.found
