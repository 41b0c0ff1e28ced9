"""The rows of inferred marker sets: what counts as right and as told, what is withheld, which commands are typed."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from benchmarks.any_capture import marker_sets, out_of_box
from benchmarks.any_capture.marked import (
    CAPTURES,
    Known,
    beside,
    hidden_names,
    known,
    leaking,
    renamed,
)
from benchmarks.any_capture.marker_sets import Judged, Score, found_segments, rows_of
from benchmarks.any_capture.out_of_box import STRANGERS, steps
from benchmarks.any_capture.set_angles import FAILED, Compared
from mbkf.model.protocol import load_protocol
from tests.captures import made_capture

KNOWN = Known("made", None, made_capture(3), load_protocol("reference36"), ())


def by_name(rows):
    return {row.name: row for row in rows}


def test_both_sides_of_a_joint_count_but_not_both_sides_of_the_body():
    assert beside("right_thigh", "right_shank")
    assert beside("left_hand", "left_forearm")
    assert not beside("right_thigh", "left_thigh")
    assert not beside("right_thigh", "right_foot")
    assert not beside("pelvis", "torso")
    assert not beside("", "pelvis")


def test_sets_that_know_the_names_are_withheld():
    names = tuple(marker.name for marker in load_protocol("plug_in_gait").markers)
    assert "plug_in_gait" in leaking(names)
    assert leaking(tuple(hidden_names(KNOWN).values())) == ()


def test_hidden_names_are_all_different_and_tell_nothing():
    names = hidden_names(KNOWN)
    assert set(names) == set(KNOWN.trial.markers.names)
    assert len(set(names.values())) == len(names)
    assert renamed(KNOWN.trial, names).markers.names[0] == "M01"


def test_nothing_found_is_wrong_but_told():
    names = hidden_names(KNOWN)
    found = found_segments(KNOWN, None, names)
    assert [(segment, sure) for segment, _, sure in found] == [("", 0.0)] * len(names)


def test_bad_scores_fail_every_row():
    bad = {"one": Score(10, 2, 1, 5, 99.0)}
    worse = {"one": FAILED}
    rows = rows_of(Judged(bad, bad, bad, worse, worse))
    assert not any(row.passed for row in rows if row.bounded)
    good = {"one": Score(10, 10, 9, 0, 1.0)}
    fine = {"one": Compared(0.5, "knee_angle_r", 3.0, 1.01)}
    assert all(row.passed for row in rows_of(Judged(good, good, good, fine, fine)))


def test_shares_are_over_all_markers_and_the_worst_capture_is_named():
    found = {"a": Score(10, 10, 10, 0, 1.0), "b": Score(30, 24, 20, 3, 1.0)}
    rows = by_name(rows_of(Judged(found, {}, {}, {}, {})))
    assert rows["marker sets, hidden names, static and trial: right"].value == pytest.approx(34 / 40)
    assert rows["marker sets, hidden names, static and trial: right, worst (b)"].value == pytest.approx(0.8)
    assert rows["marker sets, hidden names: wrong and not told"].value == pytest.approx(3 / 40)


def test_what_is_typed_names_no_protocol(tmp_path):
    for one in STRANGERS:
        typed = steps(one, tmp_path, tmp_path)
        assert [words[0] for words in typed] == ["info", "scale", "reconstruct", "report"]
        assert not any("--protocol" in words for words in typed)


def test_steps_that_fail_fail_their_rows(tmp_path):
    """Nothing is there to read."""
    rows = out_of_box.stranger_rows(STRANGERS[2], tmp_path, tmp_path / "out")
    assert rows[0].value == 4
    assert not any(row.passed for row in rows)


def test_a_capture_is_judged_by_hidden_and_by_own_names(real_data, monkeypatch):
    """By an inference that knows the hidden names; of the own ones it finds one only."""
    chosen = tuple(replace(one, walks=False) for one in CAPTURES if one.name == "bmc lower walk")
    monkeypatch.setattr(marker_sets, "CAPTURES", chosen)
    one = known(chosen[0], real_data)
    truth = {name: one.segments[own] for own, name in hidden_names(one).items()}
    truth |= dict([next(iter(one.segments.items()))])
    asked = []

    def infer(static, trials, leave_out):
        asked.append((static, len(trials), leave_out))
        markers = [
            SimpleNamespace(name=name, segment=truth.get(name, ""), probability=1.0)
            for name in trials[0].markers.names
        ]
        return SimpleNamespace(protocol=SimpleNamespace(markers=markers))

    monkeypatch.setattr(marker_sets, "infer_marker_set", infer)
    lines = []
    found = marker_sets.judged(real_data, told=lines.append)
    assert asked == [(None, 1, one.withheld)] * 2
    assert found.moving["bmc lower walk"].share == 1.0
    assert found.named["bmc lower walk"].right == 1
    assert len(lines) == 2
