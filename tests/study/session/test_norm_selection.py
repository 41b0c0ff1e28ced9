"""Persons of norms: each reason to leave a trial or a person out, and the part of a gait that some trials are."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.session import TrialKind
from mbkf.io.verdict import Reason, Verdict
from mbkf.study.session.agreement import Disagreement
from mbkf.study.session.gather import session_of
from mbkf.study.session.norm_selection import norm_selection, of_trials, speed_of
from tests.study.session.sessions import person, session, walks


def reasons(one):
    found = norm_selection([one])
    return [left.sentence for left in found.left_out], len(found.persons)


def with_trial(one, **changes):
    first, *others = one.trials
    return replace(one, trials=(replace(first, **changes), *others))


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"kind": TrialKind.RUN}, "session 5, walk 0: no walk (run)"),
        ({"kind": TrialKind.TURN}, "session 5, walk 0: no walk (turn)"),
        (
            {"kind": TrialKind.UNKNOWN},
            "session 5, walk 0: movement not recognised; state its kind in the session",
        ),
        ({"verdict": "look", "remarks": ("a gap", "more")}, "session 5, walk 0: look: a gap"),
        ({"verdict": "do not use", "remarks": ()}, "session 5, walk 0: do not use: see its report"),
    ],
)
def test_trials_that_do_not_belong_are_named(changes, reason):
    assert reasons(with_trial(person(), **changes)) == ([reason], 1)
    kept = norm_selection([with_trial(person(), **changes)]).persons[0].gait
    assert kept.trials == ("walk 1",) and {c.trial for s in kept.sides for c in s.cycles} == {"walk 1"}


def test_persons_that_do_not_belong_are_named():
    assert reasons(session()) == (["session 5: age and sex not stated; write them into the session"], 0)
    assert reasons(replace(person(), sex=None)) == (
        ["session 5: sex not stated; write it into the session"],
        0,
    )
    assert reasons(replace(person(), gaits=()))[0] == ["session 5: no walk that may be used"]
    (gait,) = person().gaits
    one_foot = replace(gait, sides=(gait.sides[0], replace(gait.sides[1], cycles=(), curves={})))
    assert reasons(replace(person(), gaits=(one_foot,)))[0] == ["session 5: no whole cycle of both feet"]
    still = replace(gait, measures=tuple(m for m in gait.measures if m.name != "Speed"))
    assert reasons(replace(person(), gaits=(still,)))[0] == ["session 5: walking speed not known"]
    other = replace(person(), disagreements=(Disagreement(("walk 1",), "do not use", "another person"),))
    assert reasons(other) == (["session 5, walk 1: do not use: another person"], 1)


def test_a_failed_trial_of_a_real_verdict_is_left_out_and_cycles_are_counted():
    turned = Verdict.of([Reason("left_leg", "do not use", "turned over", "wrong", "check names")])
    one, two = walks()
    made = replace(session_of([replace(one, verdict=turned), two], "Ana"), sex="female", age=30.0)
    found = norm_selection([made])
    assert found.left_out[0].trial == "walk 0" and "turned over" in found.left_out[0].reason
    assert (
        found.cycles
        == found.persons[0].facts.cycles
        == sum(c.trial == "walk 1" for s in made.gaits[0].sides for c in s.cycles)
    )


def test_the_part_of_a_gait_has_its_own_cycles_and_measures():
    (gait,) = person().gaits
    part = of_trials(gait, {"walk 1"})
    for side, whole in zip(part.sides, gait.sides, strict=True):
        rows = [k for k, c in enumerate(whole.cycles) if c.trial == "walk 1"]
        for key, curves in side.curves.items():
            np.testing.assert_array_equal(curves.values, whole.curves[key].values[rows])
    speeds = next(m for m in session().gaits[0].measures if m.name == "Speed")
    own = [
        v
        for side in "rl"
        for v, t in zip(speeds.values[side], speeds.trials[side], strict=True)
        if t == "walk 1"
    ]
    assert speed_of(part) == pytest.approx(np.mean(own))
    assert np.isnan(speed_of(of_trials(gait, set())))


def test_walks_with_an_orthosis_or_in_another_condition_are_named():
    aided = with_trial(person(), condition="orthosis")
    assert reasons(aided) == (["session 5, walk 0: condition orthosis"], 1)
    mixed = with_trial(person(), condition="shoes")
    assert reasons(mixed) == (["session 5, walk 0: condition shoes"], 1), "one condition counts"
