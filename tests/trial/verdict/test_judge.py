"""The verdict of a result: equal evidence gives equal verdicts, and frames follow from it."""

from dataclasses import replace

from mbkf.io.findings import judged
from mbkf.trial.checks import mass
from mbkf.trial.verdict.evidence import Evidence, evidence_of
from mbkf.trial.verdict.judge import judge, judged_result, verdict_of
from tests.recordings import walk

HEAVY = judged(mass.NAME, 50.0, 1.0, "%", 5.0, "the plates give 90 kg")
LIGHT = judged(mass.NAME, 9.0, 1.0, "%", 5.0, "the plates give 66 kg")


def test_a_right_walk_may_be_used():
    r = judged_result(walk())
    assert r.verdict is not None and r.verdict.overall == "use"
    assert r.valid.all()


def test_no_frame_is_valid_where_loads_are_not_to_be_used():
    r = judged_result(replace(walk(), checks=(HEAVY,)))
    assert r.verdict is not None and r.verdict.parts["left_leg_loads"] == "do not use"
    assert not r.valid.any() and r.measured.all()
    assert judged_result(replace(walk(), checks=(LIGHT,))).valid.all(), "to be looked at, not left alone"


def test_the_verdict_is_a_function_of_the_evidence_alone():
    r = replace(walk(), checks=(LIGHT,))
    assert judge(evidence_of(r)) == judge(replace(evidence_of(r))) == judged_result(r).verdict
    assert judge(Evidence()).reasons == ()


def test_an_older_file_is_judged_when_it_is_read():
    r = replace(walk(), checks=(LIGHT,))
    assert r.verdict is None
    assert verdict_of(r).overall == "look"
    assert verdict_of(r) == judged_result(r).verdict
