"""OpenSim's files: units, axes, names; the ground's wrench stays the same wrench."""

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.io.capture_options import CaptureOptions
from mbkf.io.results_opensim import (
    TITLES,
    opensim_table,
    reconstructed_markers,
    write_opensim,
)
from mbkf.io.storage import read_storage
from mbkf.io.trc import read_trc
from tests.io.reconstructions import made_up, made_up_whole, with_trunk


def to_world(vectors):
    return np.stack([vectors[:, 0], -vectors[:, 2], vectors[:, 1]], axis=1)


def vector(table, prefix):
    return np.column_stack([table.column(prefix + axis) for axis in "xyz"])


def wrench_of(table, side):
    """(T, 6) the table's force, point and moment as one wrench about the world's origin."""
    force, point = vector(table, f"ground_force_{side}_v"), vector(table, f"ground_force_{side}_p")
    moment = vector(table, f"ground_torque_{side}_") + np.cross(point, force)
    return np.hstack([to_world(force), to_world(moment)])


def test_angles_are_in_degrees_and_translations_in_metres():
    r = made_up()
    table = opensim_table(r, "angles.mot")
    assert table.in_degrees
    np.testing.assert_allclose(table.column("hip_flexion_r"), np.rad2deg(r.angle("hip_flexion_r")))
    np.testing.assert_array_equal(table.column("pelvis_tx"), r.angle("pelvis_tx"))


def test_angles_are_told_in_both_frames_and_say_which(tmp_path):
    lab = np.array(made_up().angles)
    lab[:, 0] += 0.7
    r = made_up(direction="progression", heading_rad=np.full(12, 0.5), angles_lab=lab)
    write_opensim(r, tmp_path)
    own, theirs = (read_storage(tmp_path / name) for name in ("angles.mot", "angles_lab.mot"))
    np.testing.assert_allclose(theirs.column("pelvis_tilt") - own.column("pelvis_tilt"), np.rad2deg(0.7))
    np.testing.assert_array_equal(theirs.column("hip_flexion_r"), own.column("hip_flexion_r"))
    np.testing.assert_allclose(own.column("pelvis_tilt"), np.rad2deg(r.angle("pelvis_tilt")))
    assert own.header["direction"] == "progression, 28.6479 degrees from the x axis"
    assert theirs.header["direction"] == "laboratory"
    turning = made_up(direction="heading", heading_rad=np.linspace(0.0, 1.0, 12), angles_lab=lab)
    assert opensim_table(turning, "angles.mot").header["Direction"] == "heading, turning with it"


def test_torques_are_named_as_inverse_dynamics_names_them():
    table = opensim_table(made_up(), "torques.sto")
    assert table.names == ("pelvis_tilt_moment", "pelvis_tx_force", "hip_flexion_r_moment")
    assert not table.in_degrees


def test_a_column_with_the_name_of_opensims_joint_is_the_moment_at_its_level():
    """The coordinate's own moment is about the body's joint, which OpenSim's name would misstate."""
    moments = np.column_stack([made_up().moments[:, :2], np.full(12, 7.0)])
    r = with_trunk(coordinate_names=("pelvis_tilt", "pelvis_tx", "lumbar_extension"), moments=moments)
    table = opensim_table(r, "torques.sto")
    np.testing.assert_array_equal(table.column("lumbar_extension_moment"), r.trunk_moment("T12/L1"))
    assert table.names[2] == "lumbar_extension_moment"
    for turn in ("extension", "bending", "rotation"):
        np.testing.assert_array_equal(table.column(f"l5_s1_{turn}_moment"), r.trunk_moment("L5/S1", turn))
        up = r.trunk_moment("L5/S1", turn, "bottom_up")
        np.testing.assert_array_equal(table.column(f"l5_s1_bottom_up_{turn}_moment"), up)
    assert table.header["TrunkLevels"] == "lumbar T12/L1, l5_s1 L5/S1"


def test_moments_that_are_not_known_throughout_cost_no_frame_of_the_table():
    moments = np.array(with_trunk().trunk_moments)
    moments[3:5, 1] = np.nan
    table = opensim_table(with_trunk(trunk_moments=moments), "torques.sto")
    assert len(table.times_s) == 12
    assert "l5_s1_extension_moment" in table.names
    assert not any("bottom_up" in name for name in table.names)


def test_reactions_are_the_same_wrench_whether_loaded_or_not():
    cop = np.array(made_up().foot_cop_m)
    cop[4:7, 0], cop[:2, 1] = np.nan, np.nan
    r = made_up(foot_cop_m=cop)
    table = opensim_table(r, "reactions.mot")
    for foot, side in enumerate("rl"):
        np.testing.assert_allclose(wrench_of(table, side), r.foot_wrench[:, foot], atol=1e-9)
    points = vector(table, "ground_force_r_p")
    np.testing.assert_array_equal(points[4:7], np.tile(points[3], (3, 1)))
    up = table.column("ground_force_l_vy")
    np.testing.assert_array_equal(up, r.foot_wrench[:, 1, 2])


def test_a_loaded_foot_has_only_its_free_moment_about_the_vertical():
    r = made_up()
    torque = vector(opensim_table(r, "reactions.mot"), "ground_torque_r_")
    np.testing.assert_allclose(torque[:, 1], r.foot_free_moment_nm[:, 0], atol=1e-9)
    np.testing.assert_allclose(torque[:, [0, 2]], 0.0, atol=1e-9)


def test_other_parts_that_ever_bear_have_columns_of_the_same_kind(tmp_path):
    r = made_up_whole()
    write_opensim(r, tmp_path)
    table = read_storage(tmp_path / "reactions.mot")
    for k, part in enumerate(("pelvis", "right_hand")):
        np.testing.assert_allclose(wrench_of(table, part), r.support_wrench[:, k], atol=1e-6)
        acts = np.isfinite(r.support_point_m[:, k]).all(axis=1)
        points = to_world(vector(table, f"ground_force_{part}_p"))
        np.testing.assert_allclose(points[acts], r.support_point_m[acts, k], atol=1e-8)
    assert not any("left_hand" in name for name in table.names), "it never bears"
    assert len(table.names) == 4 * 9
    assert table.header["contacts"] == "right_foot, left_foot, pelvis, right_hand"
    assert table.header["estimated"] == "pelvis, right_hand"


def test_feet_alone_have_the_columns_of_before():
    names = opensim_table(made_up(), "reactions.mot").names
    assert names[:3] == ("ground_force_r_vx", "ground_force_r_vy", "ground_force_r_vz") and len(names) == 18
    assert opensim_table(made_up(), "reactions.mot").header["Estimated"] == "none"
    shared = made_up(foot_source=np.tile([1, 2], (12, 1)))
    assert opensim_table(shared, "reactions.mot").header["Estimated"] == "left_foot"


def test_a_foot_never_loaded_has_its_point_at_the_origin():
    r = made_up(foot_cop_m=np.full((12, 2, 3), np.nan))
    np.testing.assert_array_equal(vector(opensim_table(r, "reactions.mot"), "ground_force_l_p"), 0.0)


def test_frames_not_tracked_and_values_not_known_are_left_out_and_nothing_is_nan(tmp_path):
    tracked = np.ones(12, bool)
    tracked[[0, 1, 6, 11]] = False
    moments = np.array(made_up().moments)
    moments[2, 0], moments[:, 1] = np.nan, np.nan
    r = made_up(tracked=tracked, moments=moments)
    write_opensim(r, tmp_path)
    angles, torques = read_storage(tmp_path / "angles.mot"), read_storage(tmp_path / "torques.sto")
    np.testing.assert_allclose(angles.times_s, r.times_s[tracked])
    assert "pelvis_tx_force" not in torques.names
    np.testing.assert_allclose(torques.times_s, r.times_s[tracked][1:])
    for name in ("angles.mot", "torques.sto", "reactions.mot"):
        assert "nan" not in (tmp_path / name).read_text().split("endheader")[1].lower()
    markers = read_trc(tmp_path / "markers.trc", CaptureOptions()).markers
    np.testing.assert_allclose(markers.times_s, r.times_s[2:11])
    assert np.argwhere(~markers.present[:, 0]).ravel().tolist() == [4]


def test_markers_come_back_from_the_file(tmp_path):
    r = made_up()
    write_opensim(r, tmp_path)
    markers = read_trc(tmp_path / "markers.trc", CaptureOptions()).markers
    assert markers.names == r.marker_names
    np.testing.assert_allclose(markers.positions_m, r.predicted_m, atol=1e-8)


def test_nothing_tracked_writes_empty_files(tmp_path):
    r = made_up(tracked=np.zeros(12, bool))
    write_opensim(r, tmp_path)
    assert reconstructed_markers(r).frames == 0
    assert len(opensim_table(r, "angles.mot").times_s) == 0


def test_every_header_tells_which_later_frames_are_known():
    r = made_up(settings={"lag_ms": 20.0})
    for name in TITLES:
        assert opensim_table(r, name).header["LaterFrames"] == "fixed lag 20 ms"


def test_the_header_tells_the_axes_that_angles_are_read_in():
    """Torques are about the body's own, whichever these are."""
    r = made_up(angles_read="pig")
    for name in ("angles.mot", "angles_lab.mot"):
        assert opensim_table(r, name).header["AnglesRead"] == "pig"
    assert opensim_table(r, "torques.sto").header["AnglesRead"] == "model"


def test_coordinates_count_from_opensims_zeros_and_the_pelvis_is_where_opensims_origin_is():
    """The pelvis lies on its back, head to the left: what is forward in it points up, what is up in it to the left."""
    names = ("pelvis_tilt", "pelvis_tx", "pelvis_ty", "pelvis_tz", "pro_sup_r")
    angles = np.random.default_rng(4).normal(size=(12, 5))
    q = np.array(made_up().q)
    q[:, 3:7] = Rotation.from_matrix([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]).as_quat()
    arrays = {
        name: np.ones((12, 5))
        for name in ("angle_rates", "moments", "angles_sd", "angle_rates_sd", "moments_sd", "singular")
    }
    own = made_up(
        coordinate_names=names,
        angles=angles,
        q=q,
        opensim_origin_m=(0.06, 0.01, -0.2),
        opensim_zeros_rad={"pro_sup_r": np.pi / 2, "pro_sup_l": 1.0},
        **arrays,
    )
    for file in ("angles.mot", "angles_lab.mot"):
        table = opensim_table(own, file)
        np.testing.assert_allclose(table.column("pro_sup_r"), np.rad2deg(angles[:, 4]) + 90.0)
        np.testing.assert_allclose(table.column("pelvis_tilt"), np.rad2deg(angles[:, 0]))
        for k, (name, along) in enumerate((("pelvis_tx", 0.01), ("pelvis_ty", 0.06), ("pelvis_tz", 0.2)), 1):
            np.testing.assert_allclose(table.column(name), angles[:, k] + along, atol=1e-12)
