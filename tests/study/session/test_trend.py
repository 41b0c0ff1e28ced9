"""The trend of a person's visits against numbers by hand: means, intervals, changes and their order."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from mbkf.errors import InvalidInput
from mbkf.io.visit import Visit
from mbkf.study.session.norms import norms_of
from mbkf.study.session.records import Measure
from mbkf.study.session.scores import gait_scores
from mbkf.study.session.trend import trend
from tests.study.session.sessions import person, session

SPEEDS = {"2025-03-01": [1.0, 1.2], "2025-01-01": [0.8, 1.0, 0.9], "2025-02-01": [1.1, 1.0]}


def visit(day, speeds, **changes):
    (gait,) = session().gaits
    values, trials = np.array(speeds), ("w",) * len(speeds)
    speed = Measure("Speed", "m/s", {"r": values, "l": values + 0.5}, {"r": trials, "l": trials})
    return replace(
        session(), gaits=(replace(gait, measures=(speed,), **changes),), visit=Visit(day), name=day
    )


def test_means_intervals_and_change_are_those_by_hand():
    found = trend([visit(day, speeds) for day, speeds in SPEEDS.items()])
    assert found.visits == ("2025-01-01", "2025-02-01", "2025-03-01")
    right, left = found.lines
    assert (right.name, right.unit, right.side, left.side, right.days) == (
        "Speed",
        "m/s",
        "r",
        "l",
        (0, 31, 59),
    )
    assert [float(one.mean.mean[0]) for one in right.points] == pytest.approx([0.9, 1.05, 1.1])
    assert [float(one.mean.mean[0]) for one in left.points] == pytest.approx([1.4, 1.55, 1.6])
    first, last = (np.array(SPEEDS[day]) for day in ("2025-01-01", "2025-03-01"))
    welch = stats.ttest_ind(last, first, equal_var=False).confidence_interval()
    assert right.change.low[0] == pytest.approx(welch.low) and right.change.high[0] == pytest.approx(
        welch.high
    )


def test_names_are_chosen_and_two_visits_are_no_trend():
    visits = [visit(day, speeds) for day, speeds in SPEEDS.items()]
    assert trend(visits, names=("Step length",)).lines == ()
    assert trend(visits[:2]) is None and trend([]) is None
    assert trend([*visits[:2], replace(visits[2], gaits=())]) is None


def test_other_conditions_are_no_part_of_it():
    conditions = dict(zip(SPEEDS, ("barefoot", "barefoot", "orthosis"), strict=True))
    visits = [visit(day, speeds, condition=conditions[day]) for day, speeds in SPEEDS.items()]
    assert trend(visits) is None
    fourth = visit("2025-04-01", [1.0, 1.1], condition="barefoot")
    assert trend([*visits, fourth]).visits == ("2025-01-01", "2025-03-01", "2025-04-01")


def test_a_visit_without_a_date_is_named():
    with pytest.raises(InvalidInput, match="session 5: the date of the visit is not stated"):
        trend([session(), *(visit(day, speeds) for day, speeds in SPEEDS.items())])


def test_scores_are_those_of_each_visit():
    norms = norms_of([person(), person(1, 6)], "ours")
    visits = [replace(session(first=first), visit=Visit(f"2025-0{first}-01")) for first in (5, 6, 7)]
    lines = {(one.name, one.side): one for one in trend(visits, norms).lines}
    alone = [gait_scores(one.gaits[0], norms) for one in visits]
    assert [one.mean.mean[0] for one in lines["GPS", ""].points] == [one.gps.mean[0] for one in alone]
    assert [one.mean.mean[0] for one in lines["GPS", "l"].points] == [
        one.sides[1].gps.mean[0] for one in alone
    ]
    assert lines["GPS", ""].norm is norms.measures["walk", "GPS"] and ("GDI", "r") not in lines
    assert not any(one.name == "GPS" for one in trend(visits, replace(norms, convention="isb")).lines)
