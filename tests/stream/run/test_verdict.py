"""The running verdict: judged as frames come, noted where it changes, and against frames that may not be used."""

from types import SimpleNamespace

import numpy as np
import pytest

from mbkf.io.findings import Finding
from mbkf.io.limb_doubts import LimbDoubt
from mbkf.stream.run.setup import prepare
from mbkf.stream.run.verdict import VerdictWatch
from mbkf.trial.loads.running import RunningLoad
from tests.captures import made_capture
from tests.stream.scripted import SETTINGS, frames_of

STILL, PULLED = RunningLoad(np.zeros(3), False), RunningLoad(np.full(3, 99.0), True)
DOUBT = LimbDoubt("left_thigh", "turned over", 0.4, 0.5, mended=True, right_from_s=0.5)
TURNED = Finding(
    "axes of plate '1'", 29.0, 0.5, "times", 1.5, "outside", "turned by 180° it fits 29 times as well"
)


class Run:
    """A standing body, followed with perfect markers; its limbs, loads and checks are as a test says."""

    def __init__(self, subject):
        stream, _ = frames_of(made_capture(2))
        self.setup = prepare(stream, subject, SETTINGS, True, lambda *_: None)
        self.doubts, self.ended = [], 0
        filter = SimpleNamespace(
            loop=SimpleNamespace(watch=None),
            limb_doubts=lambda: tuple(self.doubts),
            limb_doubts_ended=0,
        )
        self.filter = filter
        self.asked, self.notes, self.logged, self.told = [], [], [], []
        self.checks = SimpleNamespace(findings=(), reached=self.asked.append, restarted=self.told.append)
        loads = SimpleNamespace(read=True, stated=tuple)
        setup = SimpleNamespace(filter=filter, stream=stream, live=self.setup.live)
        note = lambda *one: self.notes.append(one)  # noqa: E731
        self.watch = VerdictWatch(
            setup, subject, loads, note, self.checks, self.logged.append, lambda: tuple(self.told)
        )
        self.number = 0

    def frames(self, count, load=STILL, started=False):
        """Whether the loads of each of the next frames may be used."""
        sensor, found = self.setup.live.inputs.sensor, []
        q = sensor.model.neutral()
        self.filter.limb_doubts_ended = self.ended
        for _ in range(count):
            row, _ = self.setup.rows.row(self.number, sensor.positions(q), None, 0.0)
            row["known"] = row["tracked"] = True
            row["q"], row["footing"], row["wrench"], row["angle_sd"] = q, 1, 0.0, 0.01
            row["foot_height_sd"], row["support"], row["started"] = 0.001, 0.0, started
            found.append(self.watch.push(row, load))
            self.number += 1
        return found

    def kinds(self):
        return [one[0] for one in self.notes]


@pytest.fixture
def run(subject):
    return Run(subject)


def test_a_right_run_may_be_used_which_is_no_incident(run):
    assert all(run.frames(100)) and run.watch.judgement is None and run.watch.plain() == {}
    assert all(run.frames(200))
    assert run.watch.judgement.verdict.overall == "use" and run.notes == []
    assert run.asked == [100, 200]
    assert run.watch.plain()["verdict"]["overall"] == "use"


def test_the_record_stays_the_same_until_something_changes(run):
    run.frames(101)
    before = run.watch.judgement
    run.frames(200)
    assert run.watch.judgement is before and before.time_s == pytest.approx(0.99)
    run.told.append("two persons are in view")
    run.frames(100)
    assert run.watch.judgement.notices == ("two persons are in view",)


def test_plates_that_are_found_turned_forbid_the_frames_that_follow(run):
    run.frames(101)
    run.checks.findings = (TURNED,)
    assert not any(run.frames(60)), "an answer of the checks is judged at once"
    assert run.watch.judgement.verdict.parts["left_leg_loads"] == "do not use"
    run.frames(200)
    assert run.kinds() == ["verdict"] and "180°" in run.notes[0][1], "once"
    run.checks.findings = ()
    run.frames(1)
    assert run.notes[1][1] == "use"


def test_frames_of_an_unexplained_force_may_not_be_used(run):
    assert not any(run.frames(5, PULLED)) and all(run.frames(5))


def test_a_mended_limb_is_noted_and_logged_at_once(run):
    run.frames(30)
    run.doubts, run.ended = [DOUBT], 1
    run.frames(2)
    assert [one[:3] for one in run.notes if one[0] == "limb"] == [("limb", DOUBT.sentence, 50)]
    assert run.logged == [DOUBT] and run.watch.judgement.limb_doubts == (DOUBT,)
    run.frames(100)
    assert run.kinds().count("limb") == 1 and run.logged == [DOUBT]
    assert run.watch.plain()["limb_doubts"][0]["limb"] == "left_thigh"


def test_a_doubt_that_goes_on_is_noted_before_it_is_logged(run):
    run.doubts = [DOUBT]
    run.frames(101)
    assert run.kinds().count("limb") == 1 and run.logged == []
    run.ended = 1
    run.watch._filter.limb_doubts_ended = 1
    run.watch.end()
    assert run.logged == [DOUBT] and run.kinds().count("limb") == 1


def test_a_run_without_a_frame_has_no_verdict(run):
    run.watch.end()
    assert run.watch.judgement is None


def test_a_verdict_that_fails_is_reported_once_and_the_run_goes_on(run, monkeypatch):
    def fails(_found):
        raise ValueError("strange")

    run.frames(100)
    monkeypatch.setattr(run.watch._evidence, "verdict", fails)
    assert not any(run.frames(150)) and run.watch.plain() == {}
    run.watch.end()
    ((kind, sentence, *_),) = run.notes
    assert kind == "verdict" and "failed (ValueError: strange)" in sentence


def test_a_start_of_the_filter_after_the_first_is_passed_on(run):
    run.frames(1, started=True)
    run.frames(40)
    run.frames(1, started=True)
    assert run.told == [41]
