"""Exchanged names of whole captures: synthetic ones with and without, and a laboratory's."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.capture import read_capture
from mbkf.io.static_exchanges import static_exchanges
from mbkf.model.protocol import load_protocol
from mbkf.scaling.records import ScalingSettings
from mbkf.scaling.verdict import DOUBTS_KEY
from mbkf.trial.preparation.exchanged import exchange_notes, names_put_right, trials_put_right
from mbkf.trial.preparation.selection import subject_markers
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.results.summary import summarise
from mbkf.trial.scale import EXCHANGED_KEY, scale
from tests.walker import walker

pytestmark = pytest.mark.slow

KINEMATIC = ReconstructSettings(filter="kinematic", smooth=False)


def exchanged(capture, a, b, frames):
    names, positions = capture.markers.names, capture.markers.positions_m.copy()
    columns = [names.index(a), names.index(b)]
    positions[frames, columns] = positions[frames, columns[::-1]]
    return replace(capture, markers=replace(capture.markers, positions_m=positions))


def test_a_clean_walk_stays_as_it_is():
    made = walker()
    markers = subject_markers(made.trial.markers, made.subject)
    same, told = names_put_right(markers, made.subject)
    assert (same, told) == (markers, ())


@pytest.mark.parametrize(("a", "b"), [("RMT1", "RMT5"), ("RHEE", "LHEE"), ("RTUB", "RKNE")])
@pytest.mark.parametrize("frames", [slice(20, 45), slice(0, None)])
def test_exchanged_names_of_a_walk_are_put_right(a, b, frames):
    made = walker()
    clean = subject_markers(made.trial.markers, made.subject)
    wrong = subject_markers(exchanged(made.trial, a, b, frames).markers, made.subject)
    right, told = names_put_right(wrong, made.subject)
    assert np.array_equal(right.positions_m, clean.positions_m, equal_nan=True)
    count = len(range(*frames.indices(clean.frames)))
    assert [({x, y}, n) for x, y, n in told] == [({a, b}, count)]
    assert f"exchanged in {count} frames, put right" in exchange_notes(told)[0]


def test_trials_are_put_right_by_the_standing_trial(real_data):
    folder = real_data / "bmc_walk_run"
    static, trial = read_capture(folder / "run_static.trc"), read_capture(folder / "run.trc")
    (right,), told = trials_put_right(static.markers, [trial], load_protocol("rajagopal_run"))
    assert told == (("RTOE", "RMT5", 43),)
    changed = (right.markers.positions_m != trial.markers.positions_m) & trial.markers.present[:, :, None]
    names = np.array(trial.markers.names)
    assert set(names[changed.any(axis=(0, 2))]) == {"RTOE", "RMT5"}
    again, none = trials_put_right(static.markers, [right], load_protocol("rajagopal_run"))
    assert (again, none) == ([right], ())


def test_a_cluster_named_back_to_front_is_put_right(real_data):
    """Front and rear markers of the left thigh have each other's names in this walk: it would be turned about."""
    folder = real_data / "opencap_s6_walk"
    static, trial = read_capture(folder / "s6_static1.trc"), read_capture(folder / "s6_walking1.trc")
    every = trial.markers.frames
    pairs = (("L_thigh1", "L_thigh3", every), ("L_thigh2", "L_thigh4", every))
    _, told = trials_put_right(static.markers, [trial], load_protocol("opencap_lab"))
    assert told == pairs
    subject = scale(static, mass_kg=59.0, settings=ScalingSettings(frames_per_trial=15))
    found = reconstruct(trial, subject, settings=KINEMATIC)
    assert found.names_exchanged == pairs
    assert np.degrees(np.abs(found.angle("hip_rotation_l"))).max() < 40.0


def test_a_laboratory_s_exchange_is_told_and_fits_better(real_data):
    """RTOE and RMT5 of this run change names back and forth in 43 of 123 frames."""
    folder = real_data / "bmc_walk_run"
    static, trial = read_capture(folder / "run_static.trc"), read_capture(folder / "run.trc")
    subject = scale(static, [trial], mass_kg=70.0, settings=ScalingSettings(frames_per_trial=15))
    assert subject.report[EXCHANGED_KEY] == [["RTOE", "RMT5", 43]]
    found = reconstruct(trial, subject, settings=KINEMATIC)
    assert found.names_exchanged == (("RTOE", "RMT5", 43),)
    assert "names RTOE and RMT5 exchanged in 43 frames, put right" in found.warnings
    assert summarise(found)["marker_rms_mm"] <= 8.0


@pytest.mark.parametrize(
    ("trial", "static", "mass_kg"),
    [
        ("biomechzoo_walk_turn/HC044A_Straight_HC044A15.c3d", "biomechzoo_walk_turn/HC044A_Static_HC044A01.c3d", 60.3),
        ("biobuddy_functional/functional_right_knee.c3d", "biobuddy_functional/static.c3d", 70.0),
    ],
)  # fmt: skip
def test_clean_captures_stay_as_they_are(trial, static, mass_kg, real_data):
    """The walk of tests/test_real_captures.py, too."""
    subject = scale(read_capture(real_data / static), mass_kg=mass_kg)
    markers = subject_markers(read_capture(real_data / trial).markers, subject)
    assert names_put_right(markers, subject) == (markers, ())


WRISTS = tuple((f"{side}.Wrist.Lat", f"{side}.Wrist.Med") for side in "RL")
TOES = ("R.Toe.Lat", "R.Toe.Med")
FEW = ScalingSettings(frames_per_trial=10)


def standing_and_walk(real_data):
    """A laboratory's captures in which inner and outer wrists have each other's names."""
    return [
        read_capture(real_data / "gait2354_walk" / f"subject01_{name}.trc") for name in ("static", "walk1")
    ]


def test_names_that_a_laboratory_exchanges_in_all_trials_are_put_right(real_data):
    static, walk = (exchanged(one, *TOES, slice(0, None)) for one in standing_and_walk(real_data))
    subject = scale(static, [walk], mass_kg=72.6, settings=FEW)
    assert set(static_exchanges(subject)) == {*WRISTS, TOES}
    assert DOUBTS_KEY not in subject.report
    every = walk.markers.frames
    assert {tuple(one) for one in subject.report[EXCHANGED_KEY]} == {
        (*pair, every) for pair in (*WRISTS, TOES)
    }
    _, told = names_put_right(subject_markers(walk.markers, subject), subject)
    assert set(told) == {(*pair, every) for pair in (*WRISTS, TOES)}


def test_names_that_are_kept_and_exchanged_in_all_trials_are_doubted(real_data):
    """Distances cannot tell the inner from the outer marker of the toes; where scaling had to move them does."""
    static, walk = (exchanged(one, *TOES, slice(0, None)) for one in standing_and_walk(real_data))
    kept = replace(FEW, correct_names=False)
    (doubt,) = scale(static, [walk], mass_kg=72.6, settings=kept).report[DOUBTS_KEY]
    assert doubt == f"{TOES[0]} and {TOES[1]} are at each other's places; check for exchanged names"
