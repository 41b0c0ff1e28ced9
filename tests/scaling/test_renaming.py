"""The likeliest names, found from wrong ones, and the rivals that come near."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.model.protocol import load_protocol
from mbkf.scaling import renaming
from mbkf.scaling.naming import NamingProblem
from mbkf.scaling.renaming import likeliest, settled_names
from tests.scaling.test_naming import trial

pytestmark = pytest.mark.slow

PROTOCOL = load_protocol("oxford_biomechzoo")
NOT_WORN = ("RPSI", "LPSI", "RMMA", "LMMA", "RD1M", "LD1M")


def worn_trial(wrong=None):
    """A person who wears part of a protocol, whose trajectories carry some names that are wrong."""
    wrong = wrong or {}
    names = {marker.name for marker in PROTOCOL.markers} - set(NOT_WORN)
    made = person(names)
    return replace(made, names=tuple(wrong.get(name, name) for name in made.names))


def person(names):
    return trial(3, keep=names, frames=5, protocol="oxford_biomechzoo")


WRONG = {
    "exchanged": {"RANK": "RLCA", "RLCA": "RANK", "RKNE": "RHFB", "RHFB": "RKNE"},
    "neighbours not worn, and a chain": {
        "SACR": "RPSI",
        "RHLX": "RD1M",
        "LHLX": "LD1M",
        "RSTL": "RMMA",
        "RHEE": "RSTL",
    },
}


@pytest.fixture
def few(monkeypatch):
    """Few changes are tried, to save time: those that matter here are the most promising."""
    monkeypatch.setattr(renaming, "TRIED", 12)


@pytest.mark.parametrize("wrong", WRONG.values(), ids=WRONG.keys())
def test_wrong_names_are_put_right(wrong, few):
    column = {name: k for k, name in enumerate(worn_trial(wrong).names)}
    problem = NamingProblem(worn_trial(wrong), PROTOCOL)
    names = [marker.name for marker in problem.markers]
    told = []
    found = likeliest(problem, lambda done, total: told.append((done, total)))
    trajectory = {column[names[m]]: u for u, m in enumerate(problem.first)}
    for k, name in enumerate(worn_trial().names):
        assert names[found.naming.marker[trajectory[k]]] == name
    truth = settled_names(NamingProblem(worn_trial(), PROTOCOL))
    assert found.naming.cost == pytest.approx(truth.cost, abs=2.0)
    assert told[-1][0] == told[-1][1]
    costs = [one.cost for one in found.rivals]
    assert costs == sorted(costs)
    assert costs[0] > found.naming.cost - 1.0
    for rival in found.rivals:
        assert (rival.marker != found.naming.marker).sum() in (1, 2)
        assert len(np.unique(rival.marker)) == len(rival.marker)


def test_legs_are_not_left_on_the_other_side(few):
    """All names beyond the knees exchanged with the other side's: many at once, which single ones do not reach."""
    beyond_knee = ("shank", "foot", "toes")
    swapped = {
        marker.name: ("L" if marker.name[0] == "R" else "R") + marker.name[1:]
        for marker in PROTOCOL.markers
        if marker.segment.endswith(beyond_knee)
    }
    problem = NamingProblem(worn_trial(swapped), PROTOCOL)
    assert settled_names(problem).cost > 0.0
    truth = settled_names(NamingProblem(worn_trial(), PROTOCOL))
    assert likeliest(problem).naming.cost == pytest.approx(truth.cost, abs=2.0)


def test_places_that_a_protocol_leaves_open_make_rivals(few):
    """Two markers of a shank whose places are hardly known may be each other; two on bone may not."""
    open_ = tuple(
        replace(marker, placement_sd_m=0.15) if marker.name in ("RTIB", "RSHN") else marker
        for marker in PROTOCOL.markers
    )
    problem = NamingProblem(worn_trial(), replace(PROTOCOL, markers=open_))
    found = likeliest(problem)
    names = [marker.name for marker in problem.markers]
    near = {
        names[m]
        for one in found.rivals
        if one.cost < found.naming.cost + 6.0
        for m in found.naming.marker[one.marker != found.naming.marker]
    }
    assert {"RTIB", "RSHN"} <= near
    assert "RKNE" not in near
