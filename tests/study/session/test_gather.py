"""Sessions are put together from results: kinds, verdicts, exclusions, names that are there twice."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.findings import Finding
from mbkf.io.results_folder import write_reconstruction
from mbkf.io.session import EventKind, FootEvent, SessionNotes, TrialKind, TrialNotes, plain_events
from mbkf.io.verdict import Reason, Verdict
from mbkf.study.batch.inputs import RECORD, write_record
from mbkf.study.session.gather import results_in, session_from, session_of, trial_summary
from mbkf.trial.gait import cycles
from mbkf.trial.gait.cycles import find_gait
from mbkf.trial.results.summary import summarise
from mbkf.viz.sentences import said
from tests.recordings import recorded
from tests.study.session.sessions import session, walks


def test_walks_are_one_group_with_all_cycles_and_parameters():
    (gait,) = session().gaits
    counted = [find_gait(r) for r in walks()]
    assert gait.kind == TrialKind.WALK and gait.trials == ("walk 0", "walk 1")
    assert [len(side.cycles) for side in gait.sides] == [sum(len(g.of(k)) for g in counted) for k in (0, 1)]
    speed = next(one for one in gait.measures if one.name == "Speed")
    own = [next(p for p in g.parameters if p.name == "Speed").values for g in counted]
    for k, side in enumerate("rl"):
        np.testing.assert_array_equal(speed.values[side], np.concatenate([values[k] for values in own]))
        assert len(speed.trials[side]) == len(speed.values[side])
    assert session().gait(TrialKind.RUN) is None and session().jumps == ()


def test_movements_are_told_and_measured():
    found = session_of([walks()[0], recorded("jump", 3.0, 2), recorded("squat", 4.0, 2)], "all")
    assert [one.kind for one in found.trials] == [TrialKind.WALK, TrialKind.JUMP, TrialKind.SQUAT]
    assert len(found.gaits) == 1 and found.jumps and found.squats


def test_what_is_stated_counts():
    notes = SessionNotes(
        sex="female", age=30.0, trials={"walk 0": TrialNotes(kind=TrialKind.RUN), "walk 1": TrialNotes()}
    )
    found = session_of(walks(), "x", notes)
    assert [one.kind for one in found.gaits] == [TrialKind.WALK, TrialKind.RUN]
    assert (found.sex, found.age) == ("female", 30.0)


def test_events_by_hand_cut_the_cycles(tmp_path):
    """Those that the session states, else those that the batch knew; here one cycle of each foot."""
    feet = {
        "right": ((0.2, "strike"), (0.8, "off"), (1.2, "strike")),
        "left": ((0.3, "off"), (0.7, "strike")),
    }
    events = tuple(
        FootEvent(side, EventKind(kind), time_s) for side, listed in feet.items() for time_s, kind in listed
    )
    stated = SessionNotes(trials={"walk 0": TrialNotes(events=events)})
    (gait,) = session_of(walks()[:1], "x", stated).gaits
    cycle = gait.sides[0].cycles[0].cycle
    assert len(gait.sides[0].cycles) == 1 and gait.sides[1].cycles == ()
    assert (cycle.start_s, cycle.off_s, cycle.end_s) == (0.2, 0.8, 1.2)
    folder = tmp_path / "walk0"
    write_reconstruction(walks()[0], summarise(walks()[0]), folder)
    found = len(session_from([folder], "x").gaits[0].sides[0].cycles)
    write_record(folder / RECORD, {"events": plain_events(events)})
    assert len(session_from([folder], "x").gaits[0].sides[0].cycles) == 1 < found
    write_record(folder / RECORD, {"events": None})
    assert len(session_from([folder], "x").gaits[0].sides[0].cycles) == found


def test_names_that_are_there_twice_stay_apart():
    found = session_of([walks()[0], walks()[0]], "x")
    assert [one.name for one in found.trials] == ["walk 0", "walk 0 (2)"]


def test_a_trial_s_word_and_reasons_are_those_of_its_verdict():
    r = walks()[0]
    lost = np.zeros(r.frames, bool)
    lost[: r.frames // 4] = True
    heavy = Finding("mass against plates", 50.0, 1.0, "%", 5.0, "outside", "the plates give 90 kg")
    assert trial_summary(r).verdict == "use" and trial_summary(r).left_out == ""
    assert trial_summary(replace(r, tracked=lost)).verdict == "do not use"
    accused = trial_summary(replace(r, checks=(heavy,)))
    assert accused.verdict == "do not use"
    assert accused.left_out == "loads of both legs, loads of the trunk"
    assert accused.remarks[0].startswith(f"do not use: {accused.left_out}; mass against plates +50 %")
    light = replace(heavy, value=9.0)
    assert trial_summary(replace(r, checks=(light,))).verdict == "look"
    assert trial_summary(replace(r, checks=(light,))).left_out == ""


def test_measures_of_a_trial_whose_legs_may_not_be_used_are_left_out():
    first, second = walks()[:2]
    turned = Verdict.of([Reason("left_leg", "do not use", "turned over", "wrong", "check names")])
    both, one = (session_of([r, second], "x").gaits[0] for r in (first, replace(first, verdict=turned)))
    assert {name for m in both.measures for names in m.trials.values() for name in names} == {
        "walk 0",
        "walk 1",
    }
    assert {name for m in one.measures for names in m.trials.values() for name in names} == {"walk 1"}
    assert [trial.left_out for trial in session_of([replace(first, verdict=turned)], "x").trials] == [
        "left leg"
    ]


def test_results_are_found_in_folders_and_read(tmp_path):
    for k, r in enumerate(walks()):
        write_reconstruction(r, summarise(r), tmp_path / "P1" / "monday" / f"walk{k}")
    found = results_in(tmp_path)
    assert [one.name for one in found] == ["walk0", "walk1"]
    assert results_in(found[0]) == [found[0]]
    read = session_from(found, "x", SessionNotes(trials={"walk 1": TrialNotes(excluded="fell")}))
    assert [one.name for one in read.trials] == ["walk 0"]
    with pytest.raises(InvalidInput, match="no results are here"):
        results_in(tmp_path / "P1" / "monday" / "nothing")
    with pytest.raises(InvalidInput, match="no trial to report on"):
        session_from(found[1:], "x", SessionNotes(trials={"walk 1": TrialNotes(excluded="fell")}))


def test_cycles_of_a_turn_are_left_out_on_demand_and_counted(tmp_path, monkeypatch):
    (r,) = walks(1)
    write_reconstruction(r, summarise(r), tmp_path)
    whole = len(find_gait(r).cycles)
    left = len(find_gait(r).of(1))
    monkeypatch.setattr(cycles, "turned_deg", lambda _, cycle: 20.0 * cycle.side)
    found = session_from([tmp_path], "x", straight=True)
    assert [len(side.cycles) for side in found.gaits[0].sides] == [whole - left, 0]
    remark = f"{left} of {whole} gait cycles left out: the pelvis turns by more than 15° in them"
    assert found.trials[0].remarks[-1] == remark
    assert (
        said(remark, "es")
        == f"{left} de {whole} ciclos de marcha omitidos: la pelvis gira más de 15° en ellos"
    )
    monkeypatch.setattr(cycles, "turned_deg", lambda *_: -20.0)
    assert session_from([tmp_path], "x", straight=True).gaits == ()
    assert remark not in session_from([tmp_path], "x").trials[0].remarks
