"""Rows of streams: clean ones accused, frames that count under a load, and the times between load and statement."""

import numpy as np
import pytest

from benchmarks.loads.live import MOST_FRAMES, Streamed, against_truth, judged_frames, live_rows
from mbkf.conventions import GRAVITY_M_S2
from mbkf.trial.synth import synthesise

RATE_HZ = 100.0


def mask(*spans, frames=400):
    found = np.zeros(frames, dtype=bool)
    for first, after in spans:
        found[first:after] = True
    return found


@pytest.mark.parametrize(
    ("acts", "spoilt", "begins_s", "after_s"),
    [
        (mask((130, 240)), 0.0, 0.3, 0.4),
        (mask((160, 200)), 10.0, 0.6, 0.0),
        (mask(), 50.0, 0.0, 0.0),
    ],
)
def test_frames_count_from_half_a_second_on(acts, spoilt, begins_s, after_s):
    found = against_truth(acts, mask((100, 200)), RATE_HZ)
    assert found == pytest.approx((spoilt, begins_s, after_s))


def one(stated, spoilt=float("nan"), longest_s=(0.2, 0.5), opened=0):
    return Streamed("walk", 100, stated, opened, spoilt, longest_s)


def rows_of(clean, violating):
    return {
        check.name.split(",")[0]: check for check in live_rows(clean, violating) if np.isfinite(check.bound)
    }


def test_rows():
    accused, opened, stated, spoilt = rows_of(
        [one(0), one(MOST_FRAMES, opened=2), one(MOST_FRAMES + 1)], [one(5, 3.0), one(0)]
    ).values()
    assert (accused.value, accused.passed) == (1, False)
    assert (opened.value, opened.passed) == (1, False)
    assert (stated.value, stated.bound, stated.passed) == (1, 2, False)
    assert (spoilt.value, spoilt.passed) == (3.0, False)
    assert all(check.passed for check in rows_of([one(0)], [one(9, 0.0)]).values())


def test_a_chair_is_stated_until_its_contact_opens():
    subject, made = synthesise("sit_to_stand", seed=0, seconds=2.6)
    acts, opened = judged_frames(made.trial, subject)
    bears = made.truth.support_wrench[:, :, 2].sum(axis=1) > 0.1 * subject.mass_kg * GRAVITY_M_S2
    assert len(acts) == len(bears)
    bears[: round(0.5 * made.trial.markers.rate_hz)] = False
    assert bears.any() and (acts ^ opened)[bears].all() and opened[bears].any()
    assert not acts[-1] and not opened[-1]
