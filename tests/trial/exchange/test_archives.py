"""Against Plug-in Gait's own points in a laboratory's file: the same names mean the same, with the same signs."""

import numpy as np
import pytest

from mbkf.io.c3d import read_c3d
from mbkf.io.capture import read_capture
from mbkf.io.capture_options import CaptureOptions
from mbkf.trial.exchange.result_c3d import write_result_c3d
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale

pytestmark = pytest.mark.slow

ALIKE = {
    "RPelvisAngles": (0.7, 0.95, 0.98), "LPelvisAngles": (0.7, 0.95, 0.98),
    "RHipAngles": (0.98, 0.9, 0.8), "LHipAngles": (0.98, 0.9, 0.8),
    "RKneeAngles": (0.98, None, 0.8), "LKneeAngles": (0.98, None, 0.8),
    "RAnkleAngles": (0.95, 0.8, 0.7), "LAnkleAngles": (0.95, 0.8, 0.7),
    "RGroundReactionForce": (0.95, 0.95, 0.95), "RAnklePower": (None, None, 0.9),
    "RHJC": (0.95, 0.99, 0.95), "LAJC": (0.9, 0.99, 0.95), "CentreOfMass": (0.95, 0.99, 0.9),
}  # fmt: skip
"""Least correlation of x, y and z; None where a curve hardly moves."""


@pytest.fixture(scope="module")
def both(real_data, tmp_path_factory):
    """Values of the points of the laboratory's file and of ours, and our events and theirs."""
    folder = real_data / "biomechzoo_walk_turn"
    trial = read_capture(folder / "HC032A_Straight_HC032A03.c3d")
    subject = scale(read_capture(folder / "HC032A_Static_HC032A01.c3d"), [], mass_kg=60.3)
    path = tmp_path_factory.mktemp("archive") / "walk.c3d"
    write_result_c3d(reconstruct(trial, subject, settings=ReconstructSettings(angles="pig")), path)
    ours = read_c3d(path, CaptureOptions())
    return {p.name: p.values for p in trial.derived}, {p.name: p.values for p in ours.derived}, trial, ours


def test_points_of_the_same_name_move_alike(both):
    theirs, ours, _, _ = both
    for name, least in ALIKE.items():
        known = np.isfinite(theirs[name]).all(axis=1) & np.isfinite(ours[name]).all(axis=1)
        assert known.sum() > 50
        for k, bound in enumerate(least):
            if bound is not None:
                r = np.corrcoef(theirs[name][known, k], ours[name][known, k])[0, 1]
                assert r > bound, (name, "xyz"[k])


def test_angles_are_as_large(both):
    theirs, ours, _, _ = both
    for name in ALIKE:
        if name.endswith("Angles"):
            assert np.abs(np.nanmean(ours[name] - theirs[name], axis=0)).max() < 4.0, name


def test_moments_are_internal_where_plug_in_gait_s_are_external(both):
    theirs, ours, _, _ = both
    name = "RAnkleMoment"
    known = np.isfinite(theirs[name]).all(axis=1) & np.isfinite(ours[name]).all(axis=1)
    assert np.corrcoef(theirs[name][known, 0], ours[name][known, 0])[0, 1] < -0.95


def test_the_laboratory_s_events_are_among_ours(both):
    _, _, trial, ours = both
    for event in trial.events:
        same = [e.time_s for e in ours.events if (e.label, e.context) == (event.label, event.context)]
        assert np.abs(np.array(same) - event.time_s).min() < 0.03, event
