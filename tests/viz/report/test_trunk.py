"""The report's section on the trunk."""

import numpy as np

from mbkf.viz.report.trunk import trunk_section
from tests.io.reconstructions import made_up, with_trunk


def test_a_chart_for_every_axis_with_both_ways_and_the_lowest_level_first():
    page = trunk_section(with_trunk())
    assert page.index("L5/S1 extension") < page.index("L5/S1 rotation") < page.index("T12/L1 extension")
    assert "top-down" in page and "bottom-up" in page
    assert page.count("<svg") == 6


def test_peaks_and_the_difference_of_the_ways_are_stated_per_kg():
    r = with_trunk()
    moments = np.zeros((12, 2, 2, 3))
    moments[4, 0, 1, 0], moments[:, 1, 1, 0] = -141.0, 70.5
    page = trunk_section(with_trunk(trunk_moments=moments))
    row = page[page.rindex("L5/S1") :]
    assert "−2.00" in row or "-2.00" in row
    assert "1.00" in row and f"{np.sqrt((11 + 9) / 12):.2f}" in row
    assert r.subject.mass_kg == 70.5


def test_without_moments_there_is_no_section():
    assert trunk_section(made_up()) == ""
    assert trunk_section(with_trunk(trunk_moments=np.full((12, 2, 2, 3), np.nan))) == ""
