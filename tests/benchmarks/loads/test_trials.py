"""The benchmark's trials: forty violators, sixty clean ones, each with a name of its own."""

from pathlib import Path

import pytest

from benchmarks.loads.judged import CLEAN, VIOLATORS
from benchmarks.loads.trials import clean_trials, violators


@pytest.mark.parametrize("made", [None, Path("made")])
def test_clean_trials(made):
    found = clean_trials(Path("data"), made)
    assert len({(one.folder, one.label) for one in found}) == len(found)
    assert len(found) == (CLEAN if made else 36)
    assert not any(one.fault or one.feet_only for one in found)


def test_violators():
    found = violators(Path("data"))
    assert len({(one.folder, one.label) for one in found}) == len(found) >= VIOLATORS
    assert all(one.fault or one.feet_only or one.name == "flywheel" for one in found)
    assert len(violators(Path("data"), quick=True)) < 10
