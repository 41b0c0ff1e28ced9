"""Exporting a subject: the file appears whole, with the subject's markers, or an error says why not."""

from xml.etree import ElementTree as ET

import numpy as np
import pytest

from mbkf.errors import FileFormatError, UnknownName
from mbkf.io.subject import Subject, SubjectMarker
from mbkf.pipelines.export import FORMATS, export_subject

SUBJECT = Subject(
    "human18",
    70.0,
    {"head": 1.1},
    (SubjectMarker("C7", "torso", np.array([-0.08, 0, 0.3]), 0.005, 0.0),),
    "p",
)


@pytest.mark.parametrize(("kind", "tag", "name"), [("urdf", "robot", "marker_C7"), ("mjcf", "mujoco", "C7")])
def test_a_subject_is_written_with_its_markers(tmp_path, kind, tag, name):
    path = tmp_path / "deeper" / f"body.{kind}"
    export_subject(SUBJECT, kind, path)
    root = ET.parse(path).getroot()
    assert root.tag == tag
    assert any(element.get("name") == name for element in root.iter())
    assert [p.name for p in path.parent.iterdir()] == [path.name]


def test_wrong_formats_and_places_are_refused(tmp_path):
    assert set(FORMATS) == {"urdf", "mjcf"}
    with pytest.raises(UnknownName, match="urdf"):
        export_subject(SUBJECT, "urfd", tmp_path / "x")
    with pytest.raises(FileFormatError, match="folder"):
        export_subject(SUBJECT, "urdf", tmp_path)
