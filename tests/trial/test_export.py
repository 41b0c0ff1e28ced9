"""Exporting a subject or a result: the file appears whole, or an error says why not."""

from xml.etree import ElementTree as ET

import numpy as np
import pytest

import mbkf
from mbkf.errors import FileFormatError, InvalidInput, UnknownName
from mbkf.io.subject import Subject, SubjectMarker
from mbkf.io.written import form_of
from mbkf.model.body_file import load_body
from mbkf.model.human import HumanModel
from mbkf.trial.export import FORMATS, RESULT_FOLDERS, RESULT_FORMATS, export_result, export_subject
from tests.recordings import walk

SUBJECT = Subject(
    "human18",
    70.0,
    {name: 1.1 if name == "head" else 1.0 for name in load_body().scale_factors},
    (SubjectMarker("C7", "torso", np.array([-0.08, 0, 0.3]), 0.005, 0.0),),
    "p",
)


@pytest.mark.parametrize(
    ("kind", "tag", "name"),
    [("urdf", "robot", "marker_C7"), ("mjcf", "mujoco", "C7"), ("osim", "OpenSimDocument", "C7")],
)
def test_a_subject_is_written_with_its_markers(tmp_path, kind, tag, name):
    path = tmp_path / "deeper" / f"body.{kind}"
    export_subject(SUBJECT, kind, path)
    root = ET.parse(path).getroot()
    assert root.tag == tag
    assert any(element.get("name") == name for element in root.iter())
    assert form_of(path) is not None
    surfaces = sorted(f"body_{segment}.vtp" for segment in HumanModel.of(SUBJECT).joints)
    beside = {"urdf": ["body.urdf.toml"], "mjcf": [], "osim": surfaces}[kind]
    assert sorted(p.name for p in path.parent.iterdir()) == [path.name, *beside]
    assert all(form_of(path.parent / name) is not None for name in beside)


def test_a_urdf_file_is_read_back_as_a_body(tmp_path):
    export_subject(SUBJECT, "urdf", tmp_path / "body.urdf")
    body = load_body(tmp_path / "body.urdf")
    own = HumanModel.of(SUBJECT)
    assert body.reference_mass_kg == pytest.approx(70.0, abs=1e-9)
    np.testing.assert_allclose(
        body.segment("head").com_m, own.pin_model.inertias[own.joint("head").joint_id].lever
    )
    assert form_of(tmp_path / "body.urdf.toml") is not None


def test_wrong_formats_and_places_are_refused(tmp_path):
    assert set(FORMATS) == {"urdf", "mjcf", "osim"}
    with pytest.raises(UnknownName, match="urdf"):
        export_subject(SUBJECT, "urfd", tmp_path / "x")
    with pytest.raises(FileFormatError, match="folder"):
        export_subject(SUBJECT, "urdf", tmp_path)


@pytest.mark.parametrize("kind", ["c3d", "bvh", "glb"])
def test_a_result_is_written_whole(tmp_path, kind):
    path = tmp_path / "deeper" / f"walk.{kind}"
    mbkf.export_result(walk(), kind, path)
    assert path.stat().st_size > 10_000
    assert form_of(path) is not None
    assert [p.name for p in path.parent.iterdir()] == [path.name]


def test_wrong_formats_and_places_of_results_are_refused(tmp_path):
    assert set(RESULT_FORMATS) == {"c3d", "csv", "v3d", "summary", "mjcf", "bvh", "glb"}
    assert set(RESULT_FOLDERS) == {"opensim", "bids"}
    with pytest.raises(UnknownName, match="bvh"):
        export_result(walk(), "bhv", tmp_path / "x")
    with pytest.raises(UnknownName, match="opensim"):
        export_result(walk(), "opensin", tmp_path / "x")
    with pytest.raises(InvalidInput, match="of the format c3d"):
        export_result(walk(), "opensim", tmp_path / "x", trial="walk.c3d")
    with pytest.raises(InvalidInput, match="belong to a trial"):
        export_result(walk(), "c3d", tmp_path / "x", forces="walk.mot")
    with pytest.raises(FileFormatError, match="folder"):
        export_result(walk(), "glb", tmp_path)
