"""Errors at places of a run of the page: counted the same each time, raised once, and without harm to the queue."""

import random
from importlib import import_module
from types import SimpleNamespace

import pytest

from benchmarks.misuse import injected
from benchmarks.misuse.injected import ERRORS, HIT, MODES, OTHER, Places
from mbkf.app.run_states import FAILED, FINISHED, RunState
from tests.studies import from_standing

SECONDS = 1.0
"""Length of the walk."""


@pytest.fixture(scope="module", autouse=True)
def bodies():
    """Bodies by the standing trial alone, whose scaling is short."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("mbkf.study.batch.person.scale_from_session", from_standing)
        yield


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(import_module("benchmarks.batch.study"), "SECONDS", SECONDS)
        return injected._lab(tmp_path_factory.mktemp("injected") / "lab", MODES[0])


@pytest.fixture(scope="module")
def count(lab):
    places = Places()
    assert injected._case(lab, MODES[0], places) == ""
    return places.count


def test_places_lie_in_scaling_filters_writing_and_the_queue(count):
    assert count > 500


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")  # the first place of all
@pytest.mark.parametrize("part", range(len(ERRORS)))
def test_an_error_anywhere_costs_only_its_run(lab, count, part):
    at = 1 + part * count // len(ERRORS) + 3 * part
    places = Places(at, ERRORS[part])
    assert injected._case(lab, MODES[0], places) == ""
    assert places.count >= at


@pytest.mark.parametrize(
    ("state", "fault"),
    [
        (RunState(FAILED, reason="No space left on device: motion.h5"), ""),
        (RunState(FINISHED, trials={"walk01": ("failed", "unforeseen MemoryError")}), ""),
        (RunState(FAILED), "no reason"),
        (RunState(FINISHED, trials={"walk01": ("failed", "")}), "no reason"),
        (RunState(FINISHED, trials={"walk01": ("done", "")}), "results of P1"),
    ],
)
def test_a_run_has_a_reason_or_whole_results(tmp_path, state, fault):
    found = injected._of_hit(SimpleNamespace(state={HIT: state}.get), tmp_path)
    assert fault in found and bool(fault) == bool(found)


def test_an_unreadable_result_is_a_fault(lab, count):
    assert count and injected._unreadable(lab, OTHER) == "", "each case leaves the other session done"
    (lab / "results" / OTHER / "walk01" / "motion.h5").write_bytes(b"")
    assert "results of P2" in injected._unreadable(lab, OTHER)


def test_places_are_spread_over_the_whole_run():
    found = injected._spread(1000, 10, random.Random(1))
    assert [place // 100 for place in (number - 1 for number in found)] == list(range(10))
