"""Warnings of a result: each condition of a track names its number of frames, and sources come in a fixed order."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.findings import Finding
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.model.clinical import dof_names
from mbkf.scaling.verdict import DOUBTS_KEY
from mbkf.trial.preparation.coverage import INFERRED_KEY
from mbkf.trial.results.warnings import (
    MOST_LISTED,
    TrackCounts,
    all_warnings,
    track_warnings,
    unexplained_remarks,
)
from tests.io.reconstructions import made_up
from tests.motions import random_model, subject_of, track_of

FRAMES = 8
MODEL = random_model(np.random.default_rng(5))
NAMES = dof_names(MODEL)


def track(**known):
    nv = MODEL.nv
    return track_of(np.zeros((FRAMES, MODEL.nq)), np.zeros((FRAMES, nv)), np.zeros((FRAMES, nv)), **known)


def warnings(unobservable=(), **known):
    flags = np.isin(NAMES, list(unobservable))
    return track_warnings(TrackCounts.of(track(**known)), NAMES, flags, "marker")


def frames(*which):
    return np.isin(np.arange(FRAMES), which)


def test_a_track_without_trouble_has_no_warnings():
    assert warnings() == []


@pytest.mark.parametrize(
    ("known", "words"),
    [
        ({"tracked": ~frames(1, 2, 5)}, f"3 of {FRAMES} frames"),
        ({"uncorrected": frames(6, 7)}, f"2 of {FRAMES} frames"),
        ({"known": ~frames(0, 3, 4), "starts": (2,)}, "in 2 frames"),
        ({"starts": (0, 4, 6)}, "anew at frames 4, 6"),
        ({"rejected": np.eye(FRAMES, 3, dtype=bool)}, "3 marker samples"),
    ],
)
def test_each_condition_is_counted(known, words):
    (line,) = warnings(**known)
    assert words in line


def test_dofs_that_no_marker_moves_are_named():
    (line,) = warnings(unobservable=NAMES[7:9])
    assert line.startswith("2 dofs move no marker") and f"{NAMES[7]}, {NAMES[8]}" in line


def test_unexplained_loads_are_listed_the_largest_first():
    loads = [UnexplainedLoad(k, k + 1, (0.0, 0.0, 100.0 + k), 1.0, 0.1) for k in range(MOST_LISTED + 2)]
    found = unexplained_remarks(loads)
    assert len(found) == MOST_LISTED + 1
    assert found[0].startswith(f"unexplained force {101 + MOST_LISTED} N upward")
    assert found[-1] == "and 2 smaller unexplained forces"
    assert unexplained_remarks(loads[:1]) == (loads[0].sentence,)
    assert all_warnings([], subject_of(MODEL), made_up(unexplained=tuple(loads[:1])))[0] == loads[0].sentence


def test_findings_come_first_and_warnings_of_the_trial_follow():
    finding = Finding("mass against plates", 9.0, 0.1, "kg", 1.0, "outside", "weigh the person")
    person = replace(
        subject_of(MODEL), report={DOUBTS_KEY: ["long arms"], INFERRED_KEY: {"told": "inferred"}}
    )
    found = all_warnings([finding], person, made_up(warnings=("of the track",)))
    assert found[0].startswith("mass against plates: +9 kg") and "weigh the person" in found[0]
    assert found[-3:] == ("inferred", "the subject file: long arms", "of the track")
