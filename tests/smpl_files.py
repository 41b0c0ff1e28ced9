"""Made-up AMASS files: joint rotations of the SMPL skeleton, random or those of a motion of our own body."""

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.io.amass import JOINTS

RATE_HZ = 100.0

UPRIGHT = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""The root's rotation of a person who faces +x in a world with z up: left is y, up is z."""


def waves(seconds=2.0, seed=0, size_rad=0.5):
    """(F, 22, 3) smooth random rotation vectors; the root moves about a person who faces +x."""
    rng, t = np.random.default_rng(seed), np.arange(round(seconds * RATE_HZ)) / RATE_HZ
    frequency, phase = rng.uniform(0.2, 0.8, (2, len(JOINTS), 3)) * [[[1.0]], [[8.0]]]
    turned = size_rad * np.sin(2 * np.pi * frequency * t[:, None, None] + phase)
    turned[:, 0] = (Rotation.from_rotvec(0.3 * turned[:, 0]) * Rotation.from_matrix(UPRIGHT)).as_rotvec()
    return turned


def marching(seconds=5.0, still_s=2.0):
    """(F, 22, 3) of a person who stands, arms hanging, and then lifts one leg after the other (up to 40° and 60°)."""
    t = np.arange(round(seconds * RATE_HZ)) / RATE_HZ
    made = np.zeros((len(t), len(JOINTS), 3))
    made[:, 0] = Rotation.from_matrix(UPRIGHT).as_rotvec()
    for side, phase in (("left", 1.0), ("right", -1.0)):
        made[:, JOINTS.index(f"{side}_shoulder"), 2] = -phase * 0.5 * np.pi
        lift = np.maximum(phase * np.sin(2 * np.pi * 0.8 * (t - still_s)), 0.0) ** 2 * (t > still_s)
        made[:, JOINTS.index(f"{side}_hip"), 0] = -np.radians(40.0) * lift
        made[:, JOINTS.index(f"{side}_knee"), 0] = np.radians(60.0) * lift
    return made


def walked(frames):
    """(F, 3) places of a root that goes on."""
    t = np.arange(frames) / RATE_HZ
    return np.column_stack([1.2 * t, 0.03 * np.sin(6.0 * t), 0.95 + 0.02 * np.sin(12.0 * t)])


def write_amass(path, rotations, joints=52, rate_key="mocap_framerate", **others):
    """An .npz as AMASS has it, of SMPL-H unless ``joints`` says otherwise."""
    frames = len(rotations)
    poses = np.zeros((frames, 3 * joints))
    poses[:, : rotations[0].size] = rotations.reshape(frames, -1)
    arrays = {
        "poses": poses,
        "trans": walked(frames),
        "betas": np.zeros(16),
        "dmpls": np.zeros((frames, 8)),
        "gender": np.array("female"),
        rate_key: np.array(RATE_HZ),
    } | others
    np.savez(path, **{name: array for name, array in arrays.items() if array is not None})
    return path
