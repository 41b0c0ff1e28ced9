"""Whole limbs that exchange names with the other side are found by poses."""

import numpy as np

from mbkf.labelling.exchanges import Exchange, undo_exchanges
from mbkf.sensors.limb_starts import opposite_markers
from mbkf.trial.preparation.exchanged_sides import crosses, exchanged_by_pose
from tests.motions import marker_positions, protocol_sensor, reference_model, smooth_motion

MODEL = reference_model()
SENSOR, _ = protocol_sensor(MODEL)
FRAMES, AT = 50, 30


def test_legs_exchanged_from_a_frame_on():
    motion = smooth_motion(MODEL, np.random.default_rng(1), swing_rad=0.15)
    right = marker_positions(SENSOR, motion.frames(FRAMES, 100.0)[0])
    order = np.arange(36)
    for a, b in opposite_markers(SENSOR).items():
        if any(part in SENSOR.segments[a] for part in ("thigh", "shank", "foot", "toes")):
            order[a] = b
    wrong = right.copy()
    wrong[AT:] = wrong[AT:, order]
    found = exchanged_by_pose(wrong, SENSOR, np.full(36, 0.005), 0.01)
    np.testing.assert_array_equal(undo_exchanges(wrong, found), right)
    assert exchanged_by_pose(right, SENSOR, np.full(36, 0.005), 0.01) == ()


def test_only_exchanges_beyond_a_segment_of_a_limb_may_be_a_limb_s():
    segments = ("pelvis", "pelvis", "left_thigh", "left_thigh", "right_thigh")
    frames = np.ones(1, dtype=bool)
    assert crosses([Exchange(0, 1, frames)], segments)
    assert crosses([Exchange(2, 4, frames)], segments)
    assert not crosses([Exchange(2, 3, frames)], segments)
    assert not crosses([], segments)
