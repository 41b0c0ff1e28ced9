"""The gait section: means, spreads, differences, and the bars of the stance phases."""

from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from mbkf.trial.gait.cycles import GaitParameter, find_gait
from mbkf.viz.report.gait import gait_section, stance_chart
from tests.recordings import walk


@pytest.fixture(scope="module")
def gait():
    return find_gait(walk())


def test_the_table_tells_mean_spread_and_difference(gait):
    made = GaitParameter("Step length", "m", (np.array([0.7, 0.8]), np.array([0.6])))
    none = GaitParameter("Step time", "s", (np.array([]), np.array([0.5, np.nan])))
    text = gait_section(replace(gait, parameters=(made, none)), walk().times_s)
    assert "0.750 ± 0.071" in text and "<td>0.600</td>" in text and "22.2 %" in text
    assert "<td>–</td><td>0.500</td><td>–</td>" in text


def test_a_treadmill_is_named(gait):
    assert "treadmill" not in gait_section(gait, walk().times_s)
    assert "treadmill at 1.20 m/s" in gait_section(replace(gait, belt_m_s=1.2), walk().times_s)


def test_without_gait_it_says_why():
    assert "No gait cycle was found" in gait_section(None, walk().times_s)


def test_bars_stand_where_the_feet_stand(gait):
    r = walk()
    svg = ET.fromstring(stance_chart(gait, r.times_s))
    bars = [e.attrib for e in svg.iter("rect")]
    per_second = 930.0 / (r.times_s[-1] - r.times_s[0])
    for foot, side in enumerate("rl"):
        mine = [b for b in bars if b["class"].split()[0] == side]
        drawn = sum(float(b["width"]) for b in mine) / per_second
        stood = (r.foot_wrench[:, foot, 2] > 20.0).mean() * (r.times_s[-1] - r.times_s[0])
        assert drawn == pytest.approx(stood, abs=0.05)
        assert sum("cut" in b["class"] for b in mine) <= 2
