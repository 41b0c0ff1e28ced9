"""The pelvis's tilt by its markers: the line from the rear to the front ones, whatever the body is taken for."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.real_truth.pelvis import pelvis_lines

PLACES = {"RASI": [0.1, -0.1, 0.0], "LASI": [0.1, 0.1, 0.0], "SACR": [-0.1, 0.0, 0.0]}


def found(body_deg, markers_deg, names=tuple(PLACES)):
    """A body inclined by one angle whose markers are by another, which head anywhere; one thigh marker."""
    frames = 5
    heading = Rotation.from_euler("z", np.linspace(0.0, 90.0, frames)[:, None], degrees=True)
    body = heading * Rotation.from_euler("y", -body_deg, degrees=True)
    line = heading * Rotation.from_euler("y", -markers_deg, degrees=True)
    q = np.zeros((frames, 8))
    q[:, 3:7] = body.as_quat()
    subject = [
        SimpleNamespace(name=name, segment="pelvis", position_m=np.array(PLACES[name])) for name in names
    ]
    subject.append(SimpleNamespace(name="RTHI", segment="right_thigh", position_m=np.array([9.0, 0.0, 0.0])))
    measured = np.array([[turn.apply(PLACES.get(m.name, m.position_m)) for m in subject] for turn in line])
    return SimpleNamespace(
        q=q,
        tracked=np.ones(frames, dtype=bool),
        subject=SimpleNamespace(markers=tuple(subject)),
        marker_names=tuple(m.name for m in subject),
        measured_m=measured,
    )


def test_body_and_markers_are_told_apart():
    assert pelvis_lines(found(12.0, -5.0)) == pytest.approx([12.0, -5.0])


def test_two_markers_of_the_pelvis_show_no_line():
    tilt, line = pelvis_lines(found(12.0, -5.0, ("RASI", "LASI")))
    assert tilt == pytest.approx(12.0)
    assert np.isnan(line)
