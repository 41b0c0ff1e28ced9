"""The profile: heights of bars and whiskers are the scores' own."""

import re

import pytest

from mbkf.viz.session.profile_chart import BOTTOM, HEIGHT, TOP, ProfileRow, profile_chart

ROOM = HEIGHT - TOP - BOTTOM


def test_bars_are_as_high_as_the_scores_and_whiskers_hold_the_interval():
    rows = [
        ProfileRow("Knee flexion", (8.0, 2.0), (4.0, 1.0), (5.0, 1.0)),
        ProfileRow("<GPS>", None, (10.0, 0.0), None),
    ]
    svg = profile_chart("Profile", rows, "°")
    heights = {
        side: [float(h) for h in re.findall(rf'class="span {side}"[^>]*height="([\d.]+)"', svg)]
        for side in "rl"
    }
    per_degree = ROOM / 10.5
    assert heights["r"] == pytest.approx([8.0 * per_degree], abs=0.1)
    assert heights["l"] == pytest.approx([4.0 * per_degree, 10.0 * per_degree], abs=0.1)
    norm = float(re.search(r'class="norm"[^>]*height="([\d.]+)"', svg)[1])
    assert norm == pytest.approx(2.0 * per_degree, abs=0.1)
    low, up = (float(v) for v in re.search(r'class="whisker" d="M[\d.]+ ([\d.]+)V([\d.]+)"', svg).groups())
    assert low - up == pytest.approx(2 * 1.0 * per_degree, abs=0.2)
    assert ">Knee<" in svg and ">flexion<" in svg and "&lt;GPS&gt;" in svg
