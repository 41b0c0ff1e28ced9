"""Contacts as stretches of time: where they begin and end, how large they get, how they are known."""

import numpy as np
import pytest

from mbkf.io.contacts import INSTANT_S, Loads, Source, bearing, foot_sources
from tests.io.reconstructions import made_up

RATE_HZ = 100.0
N, M, S, E = Source.NONE, Source.MEASURED, Source.SHARED, Source.ESTIMATED


def loads(source, force=(0.0, 0.0, 300.0), sd=(3.0, 4.0, 12.0), name="pelvis"):
    """One part with a force that does not change."""
    frames = len(source)
    wrench, spread = np.zeros((frames, 1, 6)), np.full((frames, 1, 6), np.nan)
    wrench[:, 0, :3], spread[:, 0, :3] = force, sd
    return Loads((name,), np.array(source)[:, None], wrench, spread, np.full((frames, 1, 3), np.nan))


def stretches(source):
    """(first frame, last frame, how) of each interval."""
    times = np.arange(len(source)) / RATE_HZ
    found = loads(source).intervals(times, RATE_HZ)
    return [(round(one.from_s * RATE_HZ), round(one.to_s * RATE_HZ), one.how) for one in found]


def test_a_stretch_is_split_where_a_plate_begins_to_read():
    found = stretches([N] * 10 + [E] * 20 + [M] * 30 + [S] * 10 + [N] * 10)
    assert found == [(10, 29, "estimated"), (30, 59, "measured"), (60, 69, "shared")]


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ([M] * 20 + [E] * 2 + [M] * 20, [(0, 41, "measured")]),  # a change of an instant
        ([M] * 20 + [N] * 4 + [M] * 20, [(0, 43, "measured")]),  # a gap of an instant
        ([M] * 20 + [N] * 5 + [M] * 20, [(0, 19, "measured"), (25, 44, "measured")]),
        ([N] * 20 + [E] * 4 + [N] * 20, []),  # a touch of an instant
        ([N] * 20 + [E] * 5 + [N] * 20, [(20, 24, "estimated")]),
        ([N] * 20 + [E] * 3 + [M] * 20, [(20, 42, "measured")]),  # contact joins contact
        ([M] * 20 + [E] * 4 + [M] * 2 + [E] * 20, [(0, 19, "measured"), (20, 45, "estimated")]),
        (([E] * 4 + [N] * 2) * 10, [(0, 59, "estimated")]),  # flicker
        ([E] * 3 + [N] * 20 + [M] * 2, []),  # at either end
        ([N] * 50, []),
        ([E] * 3, [(0, 2, "estimated")]),  # no neighbour to join
        ([], []),
    ],
)
def test_what_is_shorter_than_an_instant_joins_what_lasts(source, expected):
    assert stretches(source) == expected
    assert round(INSTANT_S * RATE_HZ) == 5


def test_peak_and_spread_are_those_of_the_force_along_itself():
    """Along (3, 0, 4)/5 the variance of independent components is (0.6·3)² + (0.8·12)²."""
    times = np.arange(30) / RATE_HZ
    part = loads([N] * 10 + [E] * 20, force=(3.0, 0.0, 4.0))
    part.wrench[15, 0, :3] *= 100.0
    (one,) = part.intervals(times, RATE_HZ)
    assert (one.part, one.measured) == ("pelvis", False)
    assert one.peak_n == pytest.approx(500.0)
    assert one.sd_n == pytest.approx(np.hypot(0.6 * 3.0, 0.8 * 12.0))


def test_an_unknown_spread_stays_unknown():
    (one,) = loads([M] * 20, sd=np.nan).intervals(np.arange(20) / RATE_HZ, RATE_HZ)
    assert one.measured and np.isnan(one.sd_n)


def test_sources_of_the_feet_follow_from_what_they_stand_on():
    contact = np.array([[-1, 0], [1, 2]])
    assert foot_sources(contact, np.zeros((2, 2, 6))).tolist() == [[E, N], [M, S]]
    wrench = np.zeros((3, 2, 6))
    wrench[0, 1, 2], wrench[2] = 5.0, np.nan
    assert foot_sources(None, wrench).tolist() == [[N, M], [N, N], [N, N]]
    assert bearing(wrench).tolist() == [[False, True], [False, False], [False, False]]


def test_a_reconstruction_lists_feet_and_parts_in_order_of_time():
    frames = 40
    support, point = np.zeros((frames, 2, 6)), np.full((frames, 2, 3), np.nan)
    support[10:, 1, 0] = 70.0
    source = np.ones((frames, 2), int)
    source[:20, 1] = N
    r = made_up(
        frames, foot_source=source, support_names=("pelvis", "left_hand"), support_wrench=support,
        support_wrench_sd=0.1 * support, support_point_m=point,
    )  # fmt: skip
    assert [(one.part, one.how) for one in r.contacts] == [
        ("right_foot", "measured"), ("left_hand", "estimated"), ("left_foot", "measured"),
    ]  # fmt: skip
    assert r.contacts[1].peak_n == 70.0 and r.contacts[1].sd_n == pytest.approx(7.0)
    assert np.isnan(r.contacts[0].sd_n), "made up without the feet's standard deviations"
    tracked = np.ones(frames, bool)
    tracked[25:] = False
    lost = made_up(frames, tracked=tracked, foot_source=source)
    assert [(one.part, one.to_s) for one in lost.contacts if one.part == "right_foot"] == [
        ("right_foot", pytest.approx(r.times_s[24]))
    ]
