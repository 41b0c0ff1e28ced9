"""A result as a folder for an OpenSim model of someone else."""

import csv
from dataclasses import replace
from shutil import copytree
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.io.storage import read_storage
from mbkf.io.written import form_of
from mbkf.model.osim import osim_files
from mbkf.trial.exchange.onto.result_onto import export_onto
from tests.recordings import leaning_walk, walker


@pytest.fixture(scope="module")
def result():
    r = leaning_walk()
    return replace(r, tracked=np.arange(r.frames) % 60 == 0)


@pytest.fixture(scope="module")
def text(result):
    """A model of theirs, without a declaration."""
    text = osim_files(walker()[1], result.subject.markers, "theirs.osim")["theirs.osim"]
    return text.replace("right_hand", "gripper").split("?>", 1)[1].strip()


@pytest.fixture(scope="module")
def model(text, tmp_path_factory):
    """The model's file, after a byte order mark."""
    path = tmp_path_factory.mktemp("model") / "theirs.osim"
    path.write_text(text, encoding="utf-8-sig")
    return path


@pytest.fixture(scope="module")
def muscular(text):
    """The model with a muscle, and with characters beyond ASCII."""
    return text.replace("</Model>", '<credits>Müller, Ångström</credits><Thelen2003Muscle name="a"/></Model>')


@pytest.fixture(scope="module")
def written(result, model, muscular, tmp_path_factory):
    """The motion, the folder, and texts of the folder for the model with a muscle, in UTF-16.

    The folder held those of the model with a muscle before.
    """
    folder, wide = tmp_path_factory.mktemp("onto") / "walk", model.with_name("wide.osim")
    wide.write_text(f'<?xml version="1.0" encoding="UTF-16"?>\n{muscular}', encoding="utf-16")
    other = folder.with_name("wide")
    export_onto(result, wide, other)
    first = {path.name: path.read_text("utf-8") for path in other.iterdir()}
    copytree(other, folder)
    return export_onto(result, model, folder), folder, first


def test_the_motion_is_in_degrees_and_metres_with_the_distances_in_its_head(result, written):
    found, folder, _ = written
    table = read_storage(folder / "motion.mot")
    assert table.in_degrees and table.names == found.kinematics.names
    np.testing.assert_allclose(table.times_s, result.times_s[result.tracked], atol=1e-9)
    for name in ("hip_flexion_r", "pelvis_tilt"):
        values = found.q[:, found.kinematics.names.index(name)]
        assert table.column(name) == pytest.approx(np.rad2deg(values), abs=1e-8)
    height = found.q[:, found.kinematics.names.index("pelvis_ty")]
    assert table.column("pelvis_ty") == pytest.approx(height)
    assert float(table.header["markersfrommeasuredmm"]) == pytest.approx(found.to_measured_mm, abs=1e-3)


def test_loads_act_on_the_models_bodies_and_others_are_left_out(result, written):
    root = ET.parse(written[1] / "ExternalLoads.xml").getroot()
    bodies = {one.get("name"): one.findtext("applied_to_body") for one in root.iter("ExternalForce")}
    assert bodies["right_foot"] == "right_foot" and bodies["pelvis"] == "pelvis"
    assert "right_hand" not in bodies
    assert "right_hand: the model has no such body" in (written[1] / "ExternalLoads.xml").read_text("utf-8")


def test_every_free_coordinate_has_an_actuator_and_the_root_a_strong_one(written):
    found, folder, _ = written
    motors = list(ET.parse(folder / "actuators.xml").getroot().iter("CoordinateActuator"))
    kinematics = found.kinematics
    assert [one.findtext("coordinate") for one in motors] == [kinematics.names[k] for k in kinematics.free]
    strong = {one.findtext("coordinate") for one in motors if float(one.findtext("optimal_force")) > 1.0}
    assert strong == {name for name in kinematics.names if name.startswith("pelvis_")}
    assert {one.get("name") for one in motors} >= {"pelvis_tx_residual", "knee_angle_r_reserve"}


def test_set_ups_name_files_of_the_folder(written):
    folder = written[1]
    for setup in ("setup_id.xml", "setup_static_optimization.xml", "setup_joint_reaction.xml"):
        root = ET.parse(folder / setup).getroot()
        for tag in ("model_file", "external_loads_file", "coordinates_file", "force_set_files"):
            assert all((folder / one.text).is_file() for one in root.iter(tag))
    muscles = ET.parse(folder / "setup_static_optimization.xml").getroot()
    forces = ET.parse(folder / "setup_joint_reaction.xml").getroot().findtext(".//forces_file")
    tool, out = muscles.find("AnalyzeTool").get("name"), muscles.findtext(".//results_directory")
    assert forces == f"{out}/{tool}_StaticOptimization_force.sto"


def test_the_model_is_theirs_and_the_folder_is_ours(text, written):
    found, folder, _ = written
    content = (folder / "model.osim").read_text("utf-8")
    assert content.startswith("<?xml") and content.split("-->", 1)[1].strip() == text
    assert all(form_of(path) for path in folder.iterdir())
    with (folder / "residuals.csv").open(encoding="utf-8", newline="") as file:
        assert next(file).startswith("#")
        rows = list(csv.DictReader(file))
    assert [row["segment"] for row in rows] == [one.pair.segment for one in found.residuals]
    assert float(rows[0]["place_mm"]) == pytest.approx(found.residuals[0].place_mm, abs=1e-3)


def test_a_model_in_utf_16_is_written_in_utf_8(written, muscular):
    declared, _, rest = written[2]["model.osim"].partition("-->")
    assert "UTF-16" not in declared and rest.strip() == muscular
    assert ET.fromstring(written[2]["model.osim"].encode()).findtext(".//credits") == "Müller, Ångström"


def test_set_ups_of_muscle_control_stand_beside_muscles_alone_and_earlier_ones_are_removed(written):
    found, folder, first = written
    new = {"setup_cmc.xml", "cmc_tasks.xml", "setup_moco.xml"}
    assert set(first) - {path.name for path in folder.iterdir()} == new
    free = [found.kinematics.names[k] for k in found.kinematics.free]
    tasks = list(ET.fromstring(first["cmc_tasks.xml"].encode()).iter("CMC_Joint"))
    assert [one.findtext("coordinate") for one in tasks] == free
    static = ET.fromstring(first["setup_static_optimization.xml"].encode())
    for setup in ("setup_cmc.xml", "setup_moco.xml"):
        root = ET.fromstring(first[setup].encode())
        files = [one.text for one in root.iter() if (one.text or "").endswith((".osim", ".mot", ".xml"))]
        assert {"model.osim", "motion.mot", "ExternalLoads.xml"} <= set(files) <= set(first)
        for tag in ("initial_time", "final_time"):
            assert root.findtext(f".//{tag}") == static.findtext(f".//{tag}")


def test_other_files_are_refused(result, tmp_path):
    (tmp_path / "x.osim").write_text("<svg/>", encoding="utf-8")
    with pytest.raises(FileFormatError):
        export_onto(result, tmp_path / "x.osim", tmp_path / "out")
    assert not (tmp_path / "out").exists()
