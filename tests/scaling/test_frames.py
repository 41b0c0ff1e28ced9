"""Which frames and markers enter scaling."""

import numpy as np
import pytest

from mbkf.errors import NotObservable
from mbkf.io.records import MarkerTrajectories
from mbkf.model.protocol import load_protocol
from mbkf.scaling.frames import MIN_MARKERS, choose_frames

PROTOCOL = load_protocol("helen_hayes")
NAMES = tuple(marker.name for marker in PROTOCOL.markers[:10])


def trial(frames, names=NAMES, offset=0.0):
    """Every sample holds its own frame and marker number, so that it can be recognised."""
    positions = np.zeros((frames, len(names), 3))
    positions[:, :, 0] = np.arange(frames)[:, None] + offset
    positions[:, :, 1] = np.arange(len(names))
    return MarkerTrajectories(tuple(names), positions, 100.0)


def with_gaps(one, *gaps):
    """The trial without some (frames, markers)."""
    positions = one.positions_m.copy()
    for where in gaps:
        positions[where] = np.nan
    return MarkerTrajectories(one.names, positions, one.rate_hz)


def numbers(frames):
    return np.nanmax(frames.measured_m[:, :, 0], axis=1)


def test_frames_are_spread_evenly_over_the_trial():
    chosen = numbers(choose_frames([trial(100)], PROTOCOL, 10))
    assert len(chosen) == 10
    assert (chosen // 10 == np.arange(10)).all()


def test_a_short_trial_gives_all_its_frames():
    np.testing.assert_array_equal(numbers(choose_frames([trial(7)], PROTOCOL, 40)), np.arange(7))


def test_each_stretch_gives_its_best_seen_frame():
    full = [3, 17, 28]
    gaps = (np.setdiff1d(np.arange(30), full)[:, None], [0, 1])
    np.testing.assert_array_equal(numbers(choose_frames([with_gaps(trial(30), gaps)], PROTOCOL, 3)), full)


def test_frames_with_too_few_markers_are_not_taken():
    gap = (np.arange(0, 20)[:, None], np.arange(MIN_MARKERS - 1, len(NAMES)))
    assert numbers(choose_frames([with_gaps(trial(40), gap)], PROTOCOL, 10)).min() >= 20


def test_trials_stand_one_after_the_other_on_common_columns():
    first, second = trial(5, NAMES[:8]), trial(5, NAMES[2:][::-1], offset=100.0)
    frames = choose_frames([first, second], PROTOCOL, 5)
    assert [m.name for m in frames.markers] == list(NAMES)
    np.testing.assert_array_equal(frames.trial, [0] * 5 + [1] * 5)
    assert np.isnan(frames.measured_m[:5, 8:]).all()
    assert np.isnan(frames.measured_m[5:, :2]).all()
    np.testing.assert_array_equal(frames.measured_m[7, 2:, 0], 102.0)
    np.testing.assert_array_equal(
        frames.measured_m[7, 2:, 1], np.arange(8)[::-1]
    )  # as the second trial has them


def test_aliases_find_their_column():
    alias = next(m for m in PROTOCOL.markers[:10] if m.aliases)
    names = [alias.aliases[0] if n == alias.name else n for n in NAMES]
    frames = choose_frames([trial(4, names)], PROTOCOL, 4)
    assert alias.name in [m.name for m in frames.markers]
    assert frames.left_out == {}


def test_what_is_left_out_is_named_with_its_reason():
    one = with_gaps(trial(100, (*NAMES, "Angle7")), (np.arange(3, 100), 6))
    frames = choose_frames([one], PROTOCOL, 100)
    assert frames.left_out == {
        "Angle7": "not a marker of the protocol",
        NAMES[6]: "seen in 3 % of the frames",
    }
    assert NAMES[6] not in [m.name for m in frames.markers]
    assert frames.measured_m.shape == (100, 9, 3)


def test_a_standing_trial_of_one_frame_shows_its_markers():
    frames = choose_frames([trial(1), trial(100, NAMES[:8])], PROTOCOL, 40)
    assert [marker.name for marker in frames.markers] == list(NAMES)
    assert frames.left_out == {}


def test_too_few_markers_are_refused():
    with pytest.raises(NotObservable, match=r"has 5 markers of protocol 'helen_hayes'.*give --protocol"):
        choose_frames([trial(10, NAMES[:5])], PROTOCOL, 10)
    with pytest.raises(NotObservable, match="its own: none"):
        choose_frames([trial(10, ())], PROTOCOL, 10)


def test_markers_never_seen_together_are_refused():
    one = trial(10)
    gaps = [(np.arange(5), slice(5, None)), (np.arange(5, 10), slice(None, 5))]
    with pytest.raises(NotObservable, match="no frame shows 6 markers"):
        choose_frames([with_gaps(one, *gaps)], PROTOCOL, 10)
