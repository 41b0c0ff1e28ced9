"""Sentences to the person: a new reason after a while, the same one after a longer while, a failure at once."""

from mbkf.stream.run import prompting
from mbkf.stream.run.events import EventLog
from mbkf.stream.run.prompting import AGAIN_S, TELL_S, Prompting


def made(monkeypatch):
    now, said = [100.0], []
    monkeypatch.setattr(prompting.time, "perf_counter", lambda: now[0])
    events = EventLog(lambda: now[0])
    return now, said, events, Prompting(said.append, events)


def test_reasons_to_wait_are_not_said_too_often(monkeypatch):
    now, said, events, prompts = made(monkeypatch)
    prompts.waiting("a marker moved")
    assert said == []
    now[0] += TELL_S
    prompts.waiting("a marker moved")
    now[0] += TELL_S
    prompts.waiting("a marker moved")
    assert said == ["waiting for a person to stand still: a marker moved"]
    prompts.waiting("few markers are seen")
    now[0] += AGAIN_S
    prompts.waiting("few markers are seen")
    assert len(said) == 3
    assert {event["kind"] for event in events.plain()} == {"waiting"}


def test_the_same_failure_is_not_repeated_at_once(monkeypatch):
    now, said, _, prompts = made(monkeypatch)
    prompts.scaling(100, named=True)
    prompts.failed("legs are bent")
    now[0] += 1.0
    prompts.scaling(100, named=False)
    prompts.failed("legs are bent")
    assert said == [
        "standing still; scaling from 100 frames …",
        "scaling failed: legs are bent; stand still once more",
    ]
    now[0] += AGAIN_S
    prompts.scaling(100, named=False)
    assert "stay where you are" in said[-1]
    assert prompts.refused == "legs are bent"
