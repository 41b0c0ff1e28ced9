"""A result put together from a track: what of it counts, and arrays that come from the capture."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.filters.tracking import track
from mbkf.io.records import PlateReadings
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.trial.preparation.filters import tracking_filter
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.results.assembly import FOOT_SD_M, assemble, before_contacts
from tests.motions import (
    capture_of,
    marker_positions,
    protocol_sensor,
    random_model,
    smooth_motion,
    subject_of,
)

FRAMES, RATE_HZ = 40, 100.0
CORNERS_M = np.array([[5.2, 5.3, 0.0], [4.8, 5.3, 0.0], [4.8, 4.7, 0.0], [5.2, 4.7, 0.0]])


@pytest.fixture(scope="module")
def trial():
    """A fall beside two plates, of which one has no geometry: capture, inputs and track of the kinematic filter."""
    rng = np.random.default_rng(7)
    model = random_model(rng)
    q, _, _ = smooth_motion(model, rng).frames(FRAMES, RATE_HZ)
    q[:, 2] -= 0.5 * GRAVITY_M_S2 * (np.arange(FRAMES) / RATE_HZ) ** 2
    sensor, names = protocol_sensor(model)
    nothing, at = np.zeros((FRAMES, 3)), np.array([5.0, 5.0, 0.0])
    plates = [
        PlateReadings(
            name, RATE_HZ, 0.0, at, nothing, nothing, np.tile(at, (FRAMES, 1)), 20.0, corners_m=corners
        )
        for name, corners in (("1", CORNERS_M), ("2", None))
    ]
    capture = capture_of(names, marker_positions(sensor, q), RATE_HZ, plates)
    capture = replace(capture, notes=("a note",))
    settings, subject = ReconstructSettings(filter="kinematic", smooth=False), subject_of(model)
    inputs, recording = trial_inputs(capture.markers, capture.plates, subject, settings)
    followed = track(tracking_filter("kinematic", inputs), recording)
    hidden = np.zeros((FRAMES, len(names)), bool)
    return capture, subject, settings, capture.markers, hidden, inputs, followed


def test_motion_is_the_tracks_and_the_trial_is_named_after_its_file(trial):
    found, followed = assemble(*trial), trial[-1]
    assert (found.trial, found.protocol, found.filter) == ("made", "reference36", "kinematic")
    for name, own in (
        ("q", "q"),
        ("sd_q", "sd_q"),
        ("sd_v_offset", "sd_v_offset"),
        ("nis", "nis"),
    ):
        np.testing.assert_array_equal(getattr(found, name), getattr(followed, own))
    assert found.warnings[0] == "a note"


def test_a_plate_without_geometry_has_unknown_corners(trial):
    corners = assemble(*trial).plate_corners_m
    np.testing.assert_array_equal(corners[0], CORNERS_M)
    assert np.isnan(corners[1]).all()


def test_frames_in_which_the_height_of_a_foot_is_not_known_do_not_count(trial):
    *before, followed = trial
    assert assemble(*trial).measured.all()
    height_sd = followed.foot_height_sd.copy()
    height_sd[3, 0], height_sd[5, 1], height_sd[7, 1] = FOOT_SD_M, 1.01 * FOOT_SD_M, np.nan
    found = assemble(*before, replace(followed, foot_height_sd=height_sd))
    for flags in (found.measured, found.valid):
        np.testing.assert_array_equal(np.flatnonzero(~flags), [5, 7])


def test_a_hidden_marker_is_predicted_where_its_skin_was(trial):
    capture, subject, settings, markers, hidden, inputs, followed = trial
    shifted = markers.positions_m.copy()
    shifted[:, 0] += 0.02
    hidden = hidden.copy()
    hidden[4:8, 0] = True
    moved = replace(markers, positions_m=shifted)
    found = assemble(capture, subject, settings, moved, hidden, inputs, followed)
    np.testing.assert_array_equal(found.measured_m, shifted)
    np.testing.assert_array_equal(found.hidden, hidden)
    off = np.linalg.norm(found.predicted_m - shifted, axis=2)[:, 0]
    assert off[hidden[:, 0]].max() < 0.01
    assert off[~hidden[:, 0]].min() > 0.01


def test_a_load_whose_contact_opened_is_not_listed():
    times_s = 0.1 * np.arange(40)
    loads = [
        UnexplainedLoad(a, b, (0.0, 0.0, 300.0), 5.0, 0.4) for a, b in ((0.5, 1.2), (2.0, 2.5), (3.0, 3.4))
    ]
    bears = np.zeros((40, 2), dtype=bool)
    bears[10:15, 1] = bears[28:, 0] = True
    assert before_contacts(loads, bears, times_s) == tuple(loads[1:])
    assert before_contacts(loads, np.zeros((40, 0), dtype=bool), times_s) == tuple(loads)
