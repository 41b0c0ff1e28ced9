"""A result as a folder for OpenSim: its files give the result's markers, wrenches and names; its tool our torques."""

from contextlib import chdir
from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.storage import read_storage
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.io.written import form_of
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.model.osim import osim_forces, to_osim_axes
from mbkf.trial.exchange.result_opensim import write_result_opensim
from tests.osim_reading import OsimModel
from tests.recordings import LOST, leaning_walk, recorded, walk, walker


@pytest.fixture(scope="module")
def result():
    tracked = leaning_walk().tracked.copy()
    tracked[LOST] = False
    return replace(leaning_walk(), tracked=tracked)


@pytest.fixture(scope="module")
def folder(result, tmp_path_factory):
    folder = tmp_path_factory.mktemp("opensim") / "walk"
    write_result_opensim(result, folder)
    return folder


def test_the_motion_puts_every_marker_where_the_result_has_it(result, folder):
    r, table = result, read_storage(folder / "motion.mot")
    assert table.in_degrees and table.title == "Coordinates"
    read = OsimModel((folder / "model.osim").read_text("utf-8"))
    np.testing.assert_allclose(table.times_s, r.times_s[r.tracked], atol=1e-9)
    lengths = np.char.startswith(table.names, "pelvis_t") & ~np.isin(table.names, "pelvis_tilt")
    for t, row in zip(np.flatnonzero(r.tracked), table.columns, strict=True):
        if t % 25:
            continue
        found = read.markers(dict(zip(table.names, np.where(lengths, row, np.deg2rad(row)), strict=True)))
        places = np.array([found[name] for name in r.marker_names])
        np.testing.assert_allclose(places, to_osim_axes(r.predicted_m[t]), atol=1e-7)


def test_the_loads_are_the_results_wrenches_each_on_the_segment_that_bears_it(result, folder):
    r, model = result, walker()[1]
    root = ET.parse(folder / "ExternalLoads.xml").getroot().find("ExternalLoads")
    table = read_storage(folder / root.findtext("datafile"))
    forces = {one.get("name"): one for one in root.iter("ExternalForce")}
    assert {"right_foot", "left_foot"} <= set(forces)
    rows = np.searchsorted(r.times_s, table.times_s - 1e-6)
    for name, one in forces.items():
        force, point, moment = (
            np.column_stack([table.column(one.findtext(f"{kind}_identifier") + axis) for axis in "xyz"])
            for kind in ("force", "point", "torque")
        )
        wrench = r.loads.wrench[rows, r.loads.names.index(name)]
        np.testing.assert_allclose(force, to_osim_axes(wrench[:, :3]), atol=1e-6)
        np.testing.assert_allclose(moment + np.cross(point, force), to_osim_axes(wrench[:, 3:]), atol=1e-6)
        assert one.findtext("applied_to_body") in model.joints
        assert one.findtext("force_expressed_in_body") == one.findtext("point_expressed_in_body") == "ground"
    assert forces["right_hand"].findtext("applied_to_body") == "right_hand"


def test_a_motor_on_every_coordinate_has_the_results_force(result, folder):
    table, model = read_storage(folder / "controls.sto"), walker()[1]
    motors = list(ET.parse(folder / "actuators.xml").getroot().iter("CoordinateActuator"))
    assert (
        [one.findtext("coordinate") for one in motors]
        == list(table.names)
        == [one.get("name") for one in motors]
    )
    assert {one.findtext("optimal_force") for one in motors} == {"1"}
    hip = table.column("hip_flexion_l")
    wanted = result.moments[result.tracked, result.coordinate_names.index("hip_flexion_l")]
    np.testing.assert_allclose(hip, wanted, atol=1e-9)
    force = table.columns[:, [table.names.index(f"pelvis_t{axis}") for axis in "xyz"]]
    R = np.array([model.placements(q)[0][model.root.joint_id] for q in result.q[result.tracked]])
    residual = np.einsum("tij,tj->ti", R, result.tau[result.tracked, :3])
    np.testing.assert_allclose(force, to_osim_axes(residual), atol=1e-9)


def test_set_ups_name_files_of_the_folder_and_times_of_the_motion(folder):
    times = read_storage(folder / "motion.mot").times_s
    analyses = ET.parse(folder / "setup_analyze.xml").getroot()[0]
    assert (folder / analyses.findtext("force_set_files")).is_file()
    assert (folder / analyses.find(".//ControlSetController").findtext("controls_file")).is_file()
    for name in ("setup_id.xml", "setup_analyze.xml"):
        tool = ET.parse(folder / name).getroot()[0]
        for entry in ("model_file", "coordinates_file", "external_loads_file"):
            assert (folder / tool.findtext(entry)).is_file()
        assert tool.findtext("lowpass_cutoff_frequency_for_coordinates") == "-1"
        span = tool.findtext("time_range") or f"{tool.findtext('initial_time')} {tool.findtext('final_time')}"
        np.testing.assert_allclose(np.array(span.split(), float), times[[0, -1]], atol=1e-9)
    assert all(form_of(path) is not None for path in folder.iterdir())


def test_forces_without_a_place_are_named_and_not_applied(tmp_path):
    load = UnexplainedLoad(0.2, 0.7, (0.0, 0.0, 300.0), 5.0, 0.4)
    write_result_opensim(replace(walk(), unexplained=(load,)), tmp_path / "x")
    text = (tmp_path / "x" / "ExternalLoads.xml").read_text("utf-8")
    assert "unexplained, not applied: 300 N upward from 0.200 to 0.700 s" in text


def test_a_result_without_loads_is_refused(tmp_path):
    r = walk()
    unknown = replace(r, foot_wrench=np.full_like(r.foot_wrench, np.nan))
    with pytest.raises(InvalidInput, match="force plates"):
        write_result_opensim(unknown, tmp_path / "x")
    assert not (tmp_path / "x").exists()


def test_opensims_inverse_dynamics_gives_our_torques(tmp_path):
    osim = pytest.importorskip("opensim", reason="needs opensim: pip install 'mbkf[peers]'")
    osim.Logger.setLevelString("Off")
    r = recorded("squat", 1.0, 5)
    write_result_opensim(r, tmp_path / "x")
    with chdir(tmp_path / "x"):
        assert osim.InverseDynamicsTool("setup_id.xml").run()
        assert osim.AnalyzeTool("setup_analyze.xml").run()
    table, model = read_storage(tmp_path / "x" / "inverse_dynamics.sto"), HumanModel.of(r.subject)
    ours = dict(zip(ClinicalAngles(model).names, osim_forces(model, r.q, r.tau).T, strict=True))
    inner = slice(10, -10)  # the spline has no third derivative at its ends, the motion has
    off = {
        column: np.abs(table.column(column) - ours[column.rpartition("_")[0]])[inner].max()
        for column in table.names
    }
    assert np.abs(ours["knee_angle_r"]).max() > 10.0
    assert max(off.values()) < 0.2, "of 700 N on the feet"
    moved = read_storage(tmp_path / "x" / "analyses" / "mbkf_BodyKinematics_acc_global.sto")
    found = np.column_stack([moved.column(f"head_{axis}") for axis in "XYZ"])
    com_m = model.pin_model.inertias[model.joint("head").joint_id].lever
    wanted = to_osim_axes(_accelerations(model, r, "head", com_m))
    np.testing.assert_allclose(found[inner], wanted[inner], atol=0.02 * np.abs(wanted).max())


def _accelerations(model, r, segment, local_m):
    """(T, 3) second differences of a point's places on a segment."""
    places = [model.placements(q) for q in r.q]
    k = model.joint(segment).joint_id
    points = np.array([p[k] + R[k] @ local_m for R, p in places])
    return np.gradient(np.gradient(points, r.times_s, axis=0), r.times_s, axis=0)
