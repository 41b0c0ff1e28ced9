"""Norms in another convention: signs are turned, angles in other axes are left out, and nothing else changes."""

import numpy as np
import pytest

from mbkf.io.norms import Band, GdiBasis, Norms
from mbkf.study.session.norm_conversion import converted
from mbkf.trial.gait.convention import BY_CLINIC, BY_ISB, BY_MODEL

T = np.linspace(0.0, 1.0, 101)
KEYS = {
    "knee": ("walk", "angle", "knee_angle"), "tilt": ("walk", "angle", "pelvis_tilt"),
    "foot": ("walk", "angle", "foot_progression"),
    "moment": ("walk", "torque", "hip_flexion"), "power": ("walk", "power", "hip"),
    "up": ("walk", "reaction", "upward"),
}  # fmt: skip


def norms():
    curves = {key: Band("x", 3, k + T, 1.0 + T) for k, key in enumerate(KEYS.values())}
    gdi = GdiBasis(("knee_angle",), np.ones((1, 51)), np.ones(1), 0.0, 1.0)
    measures = {
        ("walk", name): Band("x", 3, np.ones(1), np.ones(1)) for name in ("Speed", "GPS", "knee_angle")
    }
    return Norms("n", curves, measures, {(1.0, 1.2): curves}, gdi=gdi, convention="clinical", axes="pig")


def test_in_their_own_convention_they_stay():
    found = converted(norms(), BY_CLINIC, ("pig",))
    assert found.norms.gdi is not None and set(found.norms.curves) == set(KEYS.values())
    assert not found.turned and not found.without_angles


@pytest.mark.parametrize("convention", [BY_MODEL, BY_ISB], ids=lambda one: one.name)
def test_in_the_same_axes_signs_are_turned_and_the_walking_direction_decides(convention):
    found = converted(norms(), convention, ("pig",))
    factors = {KEYS["knee"]: 1.0, KEYS["moment"]: -1.0, KEYS["power"]: 1.0, KEYS["up"]: 1.0}
    for bands in (found.norms.curves, found.norms.by_speed[1.0, 1.2]):
        assert bands.keys() == factors.keys()
        for key, factor in factors.items():
            np.testing.assert_array_equal(bands[key].mean, factor * norms().curves[key].mean)
            np.testing.assert_array_equal(bands[key].sd, norms().curves[key].sd)
    assert found.turned and not found.without_angles and found.norms.read == (convention.name, "pig")
    assert list(found.norms.measures) == [("walk", "Speed")] and found.norms.gdi is None


@pytest.mark.parametrize("axes", [("model",), ("pig", "isb")])
def test_angles_in_other_axes_are_left_out(axes):
    found = converted(norms(), BY_MODEL, axes)
    assert set(found.norms.curves) == {KEYS["moment"], KEYS["power"], KEYS["up"]} and found.without_angles
