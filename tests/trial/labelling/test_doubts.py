"""What is told of labels that may be others."""

from dataclasses import replace

import pytest

from mbkf.model.protocol import load_protocol
from mbkf.scaling.naming import NamingProblem
from mbkf.scaling.renaming import Renamed
from mbkf.trial.labelling.doubts import Doubt, Doubts, doubts
from tests.scaling.test_naming import exchanged, trial

PROTOCOL = load_protocol("reference36")
CASE = Doubt(("RTH2",), ("RTH3",), 4.0, (0.012,), (0.031,))
NONE = Doubts((), {}, 0.2, 0, ())


def test_a_case_names_both_labels_and_the_evidence():
    told = CASE.text()
    assert "RTH2 may be RTH3 (12 and 31 mm" in told
    assert "4.0 times" in told
    assert CASE.summary() == {
        "labels": ["RTH2"],
        "may_be": ["RTH3"],
        "odds": 4.0,
        "from_place_mm": [12.0],
        "from_other_place_mm": [31.0],
    }


def test_nothing_is_told_where_nothing_is_in_doubt():
    assert NONE.warnings() == ()
    assert NONE.labels == ()
    # Further points are no sign of wrong labels where no marker is left for them.
    assert replace(NONE, nameless=3, unused=("RASI",)).warnings() == ()


@pytest.mark.parametrize(
    ("one", "said"),
    [
        (replace(NONE, cases=(CASE,)), "RTH2 may be RTH3"),
        (replace(NONE, far_m={"RTH1": 0.3}), "RTH1 (300 mm)"),
        (replace(NONE, misfit=1.6), "the points fit the body poorly"),
        (replace(NONE, nameless=1, unused=("RASI", "LASI")), "1 tracks"),
    ],
)
def test_each_doubt_is_told_with_what_settles_it(one, said):
    told = one.warnings()
    assert said in told[0]
    assert "--static" in told[-1]


def test_names_that_hang_together_are_told_at_once():
    swap = Doubt(("A", "B"), ("B", "A"), 3.0, (0.01, 0.01), (0.02, 0.02))
    other = Doubt(("B", "C"), ("C", "B"), 2.0, (0.01, 0.01), (0.02, 0.02))
    free = Doubt(("C",), ("D",), 9.0, (0.01,), (0.02,))
    told = replace(NONE, cases=(swap, CASE, free, other)).warnings()
    assert told[0] == "A, B, C may be exchanged or be D; the labels given are 2.0 times more likely"
    assert told[1] == CASE.text()
    assert told[2].startswith("4 labels")


def test_doubts_are_the_rivals_that_come_near():
    problem = NamingProblem(trial(), PROTOCOL)
    own = problem.fitted(problem.first, None, 40)
    other = replace(own, marker=exchanged(problem, "RKNE", "RTUB"))
    near, far = replace(other, cost=own.cost + 2.0), replace(other, cost=own.cost + 20.0)
    found = doubts(problem, Renamed(own, (near, far)), 0)
    assert len(found.cases) == 1
    assert set(found.cases[0].labels) == {"RKNE", "RTUB"} == set(found.cases[0].others)
    assert found.cases[0].odds == pytest.approx(2.718, abs=0.001)
    assert found.unused == ()
    assert found.misfit == own.misfit


def test_a_marker_far_from_its_place_is_in_doubt():
    problem = NamingProblem(trial(), PROTOCOL)
    own = problem.fitted(problem.first, None, 40)
    assert doubts(problem, Renamed(own, ()), 0).far_m == {}
    offsets = own.state.offsets_m.copy()
    knee = [marker.name for marker in problem.markers].index("RKNE")
    offsets[knee] = [0.0, 0.05, 0.0]
    astray = replace(own, state=replace(own.state, offsets_m=offsets))
    assert doubts(problem, Renamed(astray, ()), 0).far_m == {"RKNE": pytest.approx(0.05)}
