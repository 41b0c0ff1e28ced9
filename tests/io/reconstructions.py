"""A small made-up reconstruction for tests of what is done with one."""

import numpy as np

from mbkf.io.muscle_bursts import MuscleBurst
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject, SubjectMarker

COORDINATES = ("pelvis_tilt", "pelvis_tx", "hip_flexion_r")


def made_up(frames=12, seed=0, **changes):
    """A reconstruction of random numbers with 7 configurations, 6 dofs, 3 coordinates and 2 markers."""
    rng = np.random.default_rng(seed)
    T, nq, nv, A, M = frames, 7, 6, len(COORDINATES), 2
    markers = tuple(SubjectMarker(name, "pelvis", rng.normal(size=3), 0.005, 0.002) for name in ("A", "B"))
    force = np.abs(rng.normal(size=(T, 2, 3))) * 300
    cop = np.concatenate([rng.normal(size=(T, 2, 2)), np.zeros((T, 2, 1))], axis=2)
    free = rng.normal(size=(T, 2))
    moment = np.cross(cop, force)
    moment[..., 2] += free
    values = {
        "trial": "walk", "protocol": "reference36", "filter": "dynamic", "smoothed": False, "version": "0",
        "subject": Subject("human18", 70.5, {"head": 1.1}, markers, "reference36", 1.8, {"rms": [0.1, None]}),
        "rate_hz": 100.0, "times_s": 0.5 + np.arange(T) / 100.0,
        "dof_names": tuple(f"pelvis_{i}" for i in range(nv)),
        "q": rng.normal(size=(T, nq)), "coordinate_names": COORDINATES, "marker_names": ("A", "B"),
        "measured_m": rng.normal(size=(T, M, 3)), "predicted_m": rng.normal(size=(T, M, 3)),
        "singular": rng.random((T, A)) < 0.5, "hidden": np.zeros((T, M), bool),
        "rejected": np.zeros((T, M), bool), "foot_wrench": np.concatenate([force, moment], axis=2),
        "foot_cop_m": cop, "foot_free_moment_nm": free, "residual_force_n": rng.normal(size=(T, 3)),
        "residual_moment_nm": rng.normal(size=(T, 3)), "tracked": np.ones(T, bool), "valid": np.ones(T, bool),
        "support_names": (), "support_wrench": np.zeros((T, 0, 6)), "support_wrench_sd": np.zeros((T, 0, 6)),
        "support_point_m": np.zeros((T, 0, 3)), "measured": np.ones(T, bool), "foot_source": np.ones((T, 2), int),
        "unobserved_dofs": ("pelvis_5",), "nis": rng.random(T), "nis_readings": np.full(T, 6),
        "step_seconds": np.full(T, 1e-3), "warnings": ("a remark, ünicode",),
        "settings": {"filter": "dynamic", "jerk": 200.0, "hide": ["A"]},
    }  # fmt: skip
    for name in ("v", "a", "tau", "sd_q", "sd_v", "sd_tau"):
        values[name] = rng.normal(size=(T, nv))
    for name in ("angles", "angle_rates", "moments", "angles_sd", "angle_rates_sd", "moments_sd"):
        values[name] = rng.normal(size=(T, A))
    return Reconstruction(**{**values, **changes})


def made_up_whole(frames=12, **changes):
    """One with every array: 2 plates that are not compared, 3 parts that may bear load; the last one never does."""
    rng = np.random.default_rng(1)
    parts = 80.0 * rng.normal(size=(frames, 3, 6))
    parts[:, 2], parts[: frames // 2, 1] = 0.0, 0.0
    optional = {
        "plate_change": np.full((frames, 2, 6), np.nan),
        "foot_wrench_sd": rng.uniform(1.0, 9.0, (frames, 2, 6)),
        "foot_contact": rng.integers(-1, 3, (frames, 2)),
        "covariance": np.zeros((frames, 12, 12)),
        "plate_corners_m": rng.normal(size=(2, 4, 3)),
        "direction": "progression",
        "heading_rad": rng.normal(size=frames),
        "support_names": ("pelvis", "right_hand", "left_hand"),
        "support_wrench": parts,
        "support_wrench_sd": rng.uniform(1.0, 9.0, parts.shape),
        "support_point_m": rng.normal(size=(*parts.shape[:2], 3)),
        "nis_by_kind": rng.random((frames, 4)),
        "nis_readings_by_kind": np.full((frames, 4), 6),
        "marker_nis": rng.random((frames, 2)),
        "marker_spread_m": rng.random((frames, 2)),
        "angles_lab": rng.normal(size=(frames, len(COORDINATES))),
        "muscle_names": ("soleus_r",),
        "emg_envelope": 1e-4 * rng.random((frames, 1)),
        "muscle_bursts": (MuscleBurst("soleus_r", 0.0, 0.05),),
        "emg_rate_hz": 1000.0,
        **_trunk(frames),
    }
    return made_up(frames, **{**optional, **changes})


def with_trunk(frames=12, **changes):
    """One with moments of the trunk at two levels, of which OpenSim has a joint at the first."""
    return made_up(frames, **{**_trunk(frames), **changes})


def _trunk(frames):
    rng = np.random.default_rng(2)
    shape = (frames, 2, 2, 3)
    return {
        "level_names": ("T12/L1", "L5/S1"),
        "level_columns": ("lumbar", "l5_s1"),
        "trunk_moments": 50.0 * rng.normal(size=shape),
        "trunk_moments_sd": rng.uniform(1.0, 9.0, shape),
        "trunk_moments_sd_offset": np.ones(shape),
    }
