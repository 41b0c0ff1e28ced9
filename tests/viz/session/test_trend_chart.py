"""Charts of a trend: points and whiskers at their places, days that leave room for one another."""

import re

import numpy as np

from mbkf.viz.session.trend_chart import TrendRow, trend_chart

LABELS = [(0, "2025-01-01"), (10, "2025-01-11"), (200, "2025-07-20"), (400, "2026-02-05")]


def test_points_stand_in_proportion_to_days_and_values():
    row = TrendRow("", [0, 10, 200, 400], [1.0, 2.0, 1.5, 1.0], [0.5, np.nan, 0.0, 0.25])
    chart = trend_chart("GPS", "°", [row], LABELS, (1.25, 0.25))
    x, y = np.array(re.findall(r'cx="([\d.]+)" cy="([\d.]+)"', chart), dtype=float).T
    np.testing.assert_allclose((x[2] - x[0]) / (x[3] - x[0]), 0.5, atol=0.002)
    np.testing.assert_allclose((y[0] - y[2]) / (y[0] - y[1]), 0.5, atol=0.005)
    ends = np.array(re.findall(r'class="interval m" d="M[\d.]+ ([\d.]+)V([\d.]+)"', chart), dtype=float)
    unit = y[0] - y[1]
    np.testing.assert_allclose(ends[:, 0] - ends[:, 1], [unit, 0.0, 0.5 * unit], atol=0.3)
    assert 'class="norm"' in chart and "2025-01-11" not in chart and "2025-07-20" in chart


def test_sides_stand_apart_and_names_are_text():
    rows = [TrendRow(side, [0, 400], [1.0, 2.0], [0.1, 0.1]) for side in "rl"]
    chart = trend_chart("<b>", "", rows, LABELS, None)
    x = np.array(re.findall(r'cx="([\d.]+)"', chart), dtype=float)
    assert x[0] - x[2] == 5.0 and "<b>" not in chart and 'class="norm"' not in chart
