"""Curves of the report: in the units shown, per side, over cycles with toe-off, forces in the walker's directions."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.model.body_file import load_body
from mbkf.model.human import HumanModel
from mbkf.trial.gait.cycles import find_gait
from mbkf.viz.report.cells import angle_cells, joint_names, reaction_cells, torque_cells
from mbkf.viz.report.motion import cycle_chart, motion_section, reaction_section
from tests.motions import assert_near
from tests.recordings import walk


def test_cells_hold_both_sides_in_the_units_shown():
    r = walk()
    knee = angle_cells(r, ("knee",))[0][0]
    assert (knee.title, knee.unit) == ("Knee flexion", "°")
    assert_near(knee.curves["l"][0], np.rad2deg(r.angle("knee_angle_l")), 1e-9)
    assert_near(knee.curves["r"][1], np.rad2deg(0.02), 1e-9)
    ankle = torque_cells(r, ("ankle",))[0][0]
    assert_near(ankle.curves["r"][0] * r.subject.mass_kg, r.moment("ankle_angle_r"), 1e-9)
    assert ankle.unit == "N m/kg"
    assert list(angle_cells(r, ("lumbar",))[0][0].curves) == [""]


def test_every_angle_of_every_joint_is_shown():
    names = joint_names(load_body())
    assert names.loaded == ("hip", "knee", "ankle")
    shown = sum(len(row) for row in angle_cells(walk(), names.legs + names.upper))
    names = {name.removesuffix("_r").removesuffix("_l") for name in walk().coordinate_names}
    assert shown == len(names) - 3, "all but the pelvis's place in the room"


def test_joints_that_nothing_observes_are_named_not_shown():
    r = replace(walk(), unobserved_dofs=("head_x", "head_y", "head_z"))
    assert angle_cells(r, ("head",)) == []
    assert "neither markers nor sensors observe them: head." in motion_section(r, None)


def test_cycles_are_drawn_with_their_toe_off():
    r = walk()
    gait = find_gait(r)
    svg = cycle_chart(r.times_s, gait, angle_cells(r, ("knee",))[0][0])
    sides = [side for side, cycles in (("r", gait.of(0)), ("l", gait.of(1))) if cycles]
    assert svg.count('class="mark ') == len(sides)
    for side in sides:
        assert f'class="line {side}"' in svg and f'class="band {side}"' in svg


def test_without_gait_there_are_no_cycles():
    r = walk()
    assert "over the gait cycle" in motion_section(r, find_gait(r))
    assert "gait cycle" not in motion_section(r, None)
    assert "gait cycle" not in reaction_section(r, None)


@pytest.mark.parametrize("turn", [0.0, 2.5])
def test_fore_aft_is_where_the_walker_faces(turn):
    r = walk()
    model = HumanModel.of(r.subject)
    c, s = np.cos(turn), np.sin(turn)
    R = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    q, wrench = r.q.copy(), r.foot_wrench.copy()
    root = model.joint("pelvis").q.start
    q[:, root : root + 3] = r.q[:, root : root + 3] @ R.T
    x, y, z, w = r.q[:, root + 3 : root + 7].T
    half_c, half_s = np.cos(turn / 2), np.sin(turn / 2)
    q[:, root + 3 : root + 7] = np.column_stack(
        [half_c * x - half_s * y, half_c * y + half_s * x, half_c * z + half_s * w, half_c * w - half_s * z]
    )
    wrench[..., :3] = r.foot_wrench[..., :3] @ R.T
    here = reaction_cells(r, 1.0, "N")
    there = reaction_cells(replace(r, q=q, foot_wrench=wrench), 1.0, "N")
    for mine, theirs in zip(here, there, strict=True):
        for side in ("r", "l"):
            assert_near(mine.curves[side][0], theirs.curves[side][0], 1e-6)
    assert_near(here[0].curves["r"][0], r.foot_wrench[:, 0, 2], 1e-9)
    assert_near(here[0].curves["r"][1], 5.0, 1e-9)


def test_missing_torques_are_explained():
    r = walk()
    unknown = np.full_like(r.moments, np.nan)
    text = motion_section(replace(r, moments=unknown, moments_sd=unknown), None)
    assert "no force plate measured this trial" in text


def test_long_trials_are_drawn_broad_and_folded_behind_their_cycles():
    r = walk()
    gait = find_gait(r)
    long = replace(r, times_s=20.0 * r.times_s, rate_hz=r.rate_hz / 20.0)
    assert 'viewBox="0 0 1110 ' not in motion_section(r, gait)
    text = motion_section(long, gait)
    assert 'viewBox="0 0 1110 ' in text
    assert "<summary>Angles and torques against time</summary>" in text
    assert "<summary>Angles and torques against time</summary>" not in motion_section(long, None)


def test_of_many_cycles_a_few_are_drawn_one_by_one():
    r = walk()
    gait = find_gait(r)
    many = replace(gait, cycles=gait.of(0) * 30)
    svg = cycle_chart(r.times_s, many, angle_cells(r, ("knee",))[0][0])
    assert svg.count('class="thin r"') == 8
    assert f"8 of {len(many.cycles)} right and 0 left" in motion_section(r, many)
