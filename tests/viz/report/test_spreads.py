"""How sure the report's curves are, in bands and in words."""

from dataclasses import replace
from html import escape

import numpy as np
import pytest

from mbkf.trial.gait.cycles import find_gait
from mbkf.viz.report.cells import angle_cells, reaction_cells, torque_cells
from mbkf.viz.report.motion import motion_section, time_chart
from mbkf.viz.report.spreads import cycle_sd, offsets_known, spread_note
from tests.motions import assert_near
from tests.recordings import walk


def shifted_walk():
    """The walk of a body that is not known exactly: 0.016 of 0.02 rad, 1.8 of 3 N m and 3 of 5 N repeat.

    0.009 rad, 1 N m and 3 N of this change within the trial.
    """
    r = walk()
    return replace(
        r,
        angles_sd_offset=0.8 * r.angles_sd,
        moments_sd_offset=0.6 * r.moments_sd,
        foot_wrench_sd_offset=0.6 * r.foot_wrench_sd,
        angles_sd_change=0.45 * r.angles_sd,
        moments_sd_change=r.moments_sd / 3.0,
        foot_wrench_sd_change=0.6 * r.foot_wrench_sd,
    )


def test_curves_carry_both_parts_in_the_units_shown():
    r = shifted_walk()
    knee = angle_cells(r, ("knee",))[0][0].curves["r"]
    assert_near(knee.inner_sd, np.rad2deg(0.015), 1e-6)
    ankle = torque_cells(r, ("ankle",))[0][0].curves["l"]
    assert_near(ankle.inner_sd * r.subject.mass_kg, 2.6, 1e-6)
    for cell in reaction_cells(r, 2.0, "N"):
        assert_near(cell.curves["r"].inner_sd, 10.0, 1e-6)


def test_bands_are_nested_where_the_offset_is_told_and_one_where_not():
    for r, kinds in ((shifted_walk(), ("band outer", "band inner")), (walk(), ("band",))):
        svg = time_chart(r.times_s, angle_cells(r, ("knee",))[0][0])
        assert [kind for kind in ("band", "band outer", "band inner") if f'class="{kind} r"' in svg] == list(
            kinds
        )
        text = motion_section(r, None)
        assert ("swatch outer" in text) == (len(kinds) == 2)
        assert escape(spread_note(r)) in text


def test_ranges_tell_the_offset_in_brackets():
    r = shifted_walk()
    assert "± 2.3 (1.8)" in motion_section(r, None)
    assert "in brackets" in motion_section(r, None) and "in brackets" not in motion_section(walk(), None)
    assert offsets_known(r) and not offsets_known(walk())


def test_the_spread_of_a_cycle_is_the_root_mean_square_over_all():
    r = walk()
    cycles = find_gait(r).cycles
    np.testing.assert_allclose(cycle_sd(r.times_s, np.full(r.frames, 0.3), cycles), 0.3, rtol=1e-12)
    assert cycle_sd(r.times_s, None, cycles) is None
    ramp = cycle_sd(r.times_s, r.times_s, cycles)
    assert ramp[0] == pytest.approx(np.sqrt(np.mean([cycle.start_s**2 for cycle in cycles])), abs=0.02)
