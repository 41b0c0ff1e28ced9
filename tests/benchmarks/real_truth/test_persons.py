"""Persons with references: their files exist, and plates are left out where they are not followed."""

import pytest

from benchmarks.real_truth.persons import PERSONS, STANDING

pytestmark = pytest.mark.slow


def test_files_exist(real_data):
    for person in PERSONS:
        folder = real_data / person.folder
        named = [person.static, *(one.forces for one in person.trials), *(one.file for one in person.trials)]
        named += [file for one in person.trials for file in (one.reference.angles, one.reference.moments)]
        assert [file for file in named if file and not (folder / file).is_file()] == []
        assert len({one.name for one in person.trials}) == len(person.trials)
        assert len({one.reference.kind for one in person.trials}) == 1


def test_a_standing_trial_is_followed_by_markers_alone(real_data):
    (child,) = [one for one in PERSONS if one.name == "HC032A"]
    standing, walk = child.trials
    assert (standing.name, child.reading) == (STANDING, "pig")
    assert child.trial(real_data, standing).plates == ()
    assert len(child.trial(real_data, walk).plates) == 2
