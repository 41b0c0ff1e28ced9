"""The rows of keypoints: their noise is as told, and wrong or missing numbers fail them."""

import numpy as np
import pytest

from benchmarks.any_capture import keypoints
from benchmarks.any_capture.keypoints import (
    CORRELATED_M,
    CORRELATION_S,
    FLEXIONS,
    MOTIONS,
    RATE_HZ,
    SETS,
    Errors,
    Scene,
    gauss_markov,
    keypoint_rows,
)
from benchmarks.checks import Context


def errors(angle_deg, torque_nm_kg):
    each = {joint: np.full(10, angle_deg) for joint in FLEXIONS.values()}
    torque = {joint: np.full(10, torque_nm_kg) for joint in each}
    return Errors(each, torque, {joint: np.full(10, 2.0) for joint in each})


def rows(monkeypatch, tmp_path, smoothed, causal):
    scene = type("Known", (), {"errors": lambda self: (smoothed, causal)})()
    monkeypatch.setattr(Scene, "of", classmethod(lambda cls, *_: scene))
    monkeypatch.setattr(keypoints, "synthesise_motion", lambda *_: None)
    return keypoint_rows(Context(None, tmp_path, quick=True))


def test_the_noise_stays_as_long_as_told():
    found = gauss_markov((4000, 300), np.random.default_rng(1))
    lag = round(RATE_HZ * CORRELATION_S)
    assert found.std() == pytest.approx(CORRELATED_M, rel=0.02)
    assert found[:100].std() == pytest.approx(CORRELATED_M, rel=0.05), "from the first frame on"
    assert np.mean(found[lag:] * found[:-lag]) / CORRELATED_M**2 == pytest.approx(np.exp(-1.0), abs=0.03)


def test_every_set_motion_and_joint_is_judged(monkeypatch, tmp_path):
    found = rows(monkeypatch, tmp_path, errors(4.9, 0.24), errors(9.0, 0.5))
    bounded = [row for row in found if row.bounded]
    assert len(bounded) == len(SETS) * len(MOTIONS) * len(FLEXIONS) * 2
    assert all(row.passed for row in found), "causal results are told for information"


@pytest.mark.parametrize("bad", [errors(5.1, 0.2), errors(4.0, 0.26), errors(np.nan, np.nan)])
def test_what_is_beyond_the_bounds_fails(monkeypatch, tmp_path, bad):
    assert not all(row.passed for row in rows(monkeypatch, tmp_path, bad, errors(1.0, 0.1)))


def test_intervals_are_counted(monkeypatch, tmp_path):
    found = rows(monkeypatch, tmp_path, errors(3.9, 0.1), errors(3.9, 0.1))
    assert {row.value for row in found if "interval" in row.name} == {100.0}
    found = rows(monkeypatch, tmp_path, errors(4.1, 0.1), errors(3.9, 0.1))
    assert {row.value for row in found if "interval" in row.name} == {0.0}
