"""The search through readings of the text."""

import numpy as np
import pytest

from benchmarks.stride_paper import readings
from benchmarks.stride_paper.reading_findings import reading_findings
from benchmarks.stride_paper.readings import HEADS, PRINTED_M, Readings, by_magnitude, by_sum, search
from mbkf.imu.key_points import stability

WORDS = (("a",) * len(HEADS), ("b",) * len(HEADS))


def test_measures_of_stability_differ_in_how_axes_become_one_number():
    force = np.zeros((2, 10, 3))
    force[0, :, 0] = force[0, :, 1] = [3.0, -3.0] * 5  # spread 3 on two axes, magnitude always 3 √2
    force[1] = [3.0, 4.0, 0.0]
    rates = np.zeros((2, 10, 3))
    rates[1] = [0.0, 0.6, 0.8]
    weights = (0.1, 1.0, 10.0)
    assert stability(force, rates, weights) == pytest.approx([0.1 * 3.0 * np.sqrt(2.0), 5.0 + 10.0])
    assert by_magnitude(force, rates, weights) == pytest.approx([0.0, 5.0 - 3.0 * np.sqrt(2.0) + 10.0])
    assert by_sum(force, rates, weights) == pytest.approx([0.6, 7.0 + 14.0])


def test_every_combination_is_run_and_none_gives_the_paper(monkeypatch):
    monkeypatch.setattr(readings, "SHAPES", {"smooth": readings.SHAPES["smooth"]})
    monkeypatch.setattr(readings, "MEASURES", {"length": stability})
    found = search()
    assert len(found.words) == len(set(found.words)) == 720
    assert {len(words) for words in found.words} == {len(HEADS)}
    printed_way = ("smooth", "1", "length", "integrated", "–", "0.5", "0", "rad/s, all axes", "absolute")
    values = found.values_m[found.words.index(printed_way)]
    assert values == pytest.approx([1.262, 0.430, 1.129, 0.357], abs=1e-3)
    assert found.near(0, 1, 2, 3) == 0
    assert found.distances_m.min() > 0.1


def test_near_readings_are_counted():
    found = Readings(WORDS, np.array([PRINTED_M + 0.009, PRINTED_M + np.array([0.0, 0.02, 0.0, 0.0])]))
    assert (found.near(0), found.near(0, 1), found.near(0, 1, 2, 3)) == (2, 1, 1)
    assert found.nearest == 0
    assert found.distances_m == pytest.approx([0.009, 0.02])
    assert reading_findings(found).claims[0].verdict == "reproduced"


def test_a_search_without_a_hit_is_stated_with_its_spread():
    found = Readings(WORDS, np.array([PRINTED_M + 0.2, PRINTED_M + 0.4]))
    result = reading_findings(found)
    assert [band.kept for band in result.bands] == [False, True, True]  # two readings are too few
    assert result.claims[0].verdict == "cannot be had"
    assert result.sheets[0].rows[0][1:3] == pytest.approx((0.32, 0.52))
    assert result.sheets[1].rows[0][-1] == pytest.approx(0.2)
