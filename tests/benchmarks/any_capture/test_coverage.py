"""The rows of mixed marker sets: what they count, and that a silent program fails them."""

import pytest

from benchmarks.any_capture import coverage
from benchmarks.any_capture.coverage import LEAST_SHARE, SETS, Verdict, coverage_rows, mixed
from mbkf.model.protocol import detect_protocol


def names_of(one):
    return mixed(one).markers.names


def rows(monkeypatch, found):
    monkeypatch.setattr(coverage, "verdict", lambda _capture: found)
    return {check.name: check for check in coverage_rows()}


def test_a_program_that_uses_few_markers_in_silence_fails(monkeypatch):
    found = rows(monkeypatch, Verdict(0.2, refused=False, warned=False, untold=3))
    assert found["coverage: sets used in silence"].value == len(SETS)
    assert found["coverage: ignored markers not told"].value == 3 * len(SETS)
    assert not found["coverage: sets used in silence"].passed


def test_a_program_that_refuses_all_fails_where_it_need_not(monkeypatch):
    found = rows(monkeypatch, Verdict(0.9, refused=True, warned=False, untold=0))
    assert found["coverage: sets used in silence"].passed
    assert not found["coverage: sets above 60 % refused"].passed
    assert not found["coverage: mixed sets below 60 %"].passed


@pytest.mark.parametrize("one", SETS, ids=lambda one: one.name)
def test_sets_are_as_mixed_as_they_say(one):
    names = names_of(one)
    assert len(set(names)) == len(names)
    known = len(detect_protocol(names).match(names))
    if not one.names:
        assert known == len(names) - one.strangers


@pytest.mark.slow
def test_rows_pass(monkeypatch):
    """All but that on the number of mixed sets, with a set of each kind: few names kept, half of them, most."""
    chosen = ("7 of 51", "15 of 30", "20 of 30")
    monkeypatch.setattr(coverage, "SETS", [one for one in SETS if one.name in chosen])
    rows = {check.name: check for check in coverage_rows()}
    assert [name for name, check in rows.items() if not check.passed] == ["coverage: mixed sets below 60 %"]
    assert rows["coverage: mixed sets below 60 %"].value == 2
    shares = [len(detect_protocol(names).match(names)) / len(names) for names in map(names_of, SETS)]
    assert sum(share < LEAST_SHARE for share in shares) >= rows["coverage: mixed sets below 60 %"].bound
