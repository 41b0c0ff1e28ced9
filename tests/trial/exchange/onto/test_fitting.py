"""A walk in the coordinates of an OpenSim model: our own body as such a model gives its own motion back."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.osim import read_osim
from mbkf.model.osim import osim_coordinates, osim_files
from mbkf.trial.exchange.onto.fitting import onto
from tests.recordings import walk, walker

EVERY = 60


@pytest.fixture(scope="module")
def result():
    """The walk, followed in some frames."""
    r = walk()
    return replace(r, tracked=np.arange(r.frames) % EVERY == 0)


@pytest.fixture(scope="module")
def text(result):
    return osim_files(walker()[1], result.subject.markers, "own.osim")["own.osim"]


def model(folder, text):
    (folder / "own.osim").write_text(text, encoding="utf-8")
    return read_osim(folder / "own.osim", markers_needed=False)


def test_our_own_model_moves_as_we_do(result, text, tmp_path):
    found = onto(result, model(tmp_path, text))
    truth = osim_coordinates(walker()[1], result.q[result.tracked])
    assert found.rows.sum() == len(found.q) == len(truth)
    assert found.q == pytest.approx(truth, abs=1e-5)
    assert set(found.markers) == set(result.marker_names)
    assert found.to_ours_mm < 1e-4
    seen = result.present[result.tracked]
    apart = (result.predicted_m - result.measured_m)[result.tracked][seen]
    assert found.to_measured_mm == pytest.approx(1e3 * np.sqrt((apart**2).sum(axis=1).mean()), abs=1e-3)
    assert {one.pair.segment for one in found.residuals} == set(walker()[1].joints)
    assert max(one.place_mm for one in found.residuals) < 1e-2
    assert max(one.turn_deg for one in found.residuals) < 1e-2


def test_bodies_alone_are_enough(result, text, tmp_path):
    """No marker bears a name of the person's: joints and upright postures place the bodies."""
    for marker in result.subject.markers:
        text = text.replace(f'Marker name="{marker.name}"', f'Marker name="other {marker.name}"')
    found = onto(result, model(tmp_path, text))
    assert found.markers == () and np.isnan(found.to_measured_mm)
    assert all(one.pair.markers == () for one in found.residuals)
    assert found.q == pytest.approx(osim_coordinates(walker()[1], result.q[result.tracked]), abs=1e-5)


def test_markers_that_lie_otherwise_are_reported(result, text, tmp_path):
    """Markers of one shank lie 30 mm higher in the model: the leg cannot follow, the arms can."""
    higher = text
    for marker in result.subject.markers:
        if marker.segment == "right_shank":
            start = higher.index(f'Marker name="{marker.name}"')
            begin = higher.index("<location>", start) + len("<location>")
            end = higher.index("</location>", begin)
            x, y, z = map(float, higher[begin:end].split())
            higher = f"{higher[:begin]}{x} {y + 0.03} {z}{higher[end:]}"
    found = {one.pair.segment: one.place_mm for one in onto(result, model(tmp_path, higher)).residuals}
    assert max(found[f"right_{part}"] for part in ("thigh", "shank", "foot")) > 2.0
    assert found["left_hand"] < 0.5


def test_locked_and_clamped_coordinates_are_kept(result, text, tmp_path):
    start = text.index('<Coordinate name="knee_angle_r">')
    begin, end = text.index("<range>", start), text.index("</clamped>", start)
    narrow = f"{text[:begin]}<range>-0.2 0.3</range><clamped>true{text[end:]}"
    left = '<Coordinate name="knee_angle_l">'
    found = onto(result, model(tmp_path, narrow.replace(left, f"{left}<locked>true</locked>")))
    right, left = (found.kinematics.names.index(f"knee_angle_{side}") for side in "rl")
    assert np.ptp(found.q[:, left]) == 0.0
    assert found.q[:, right].max() == 0.3
    assert list(found.limited) == ["knee_angle_r"] and 0.0 < found.limited["knee_angle_r"] < 1.0


def test_a_result_that_is_followed_in_no_frame_is_refused(result, text, tmp_path):
    with pytest.raises(InvalidInput, match="follows the body in no frame"):
        onto(replace(result, tracked=np.zeros(result.frames, dtype=bool)), model(tmp_path, text))
