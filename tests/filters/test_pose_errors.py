"""Roots of pose errors by sums over segments against the markers' own Jacobian, one row a coordinate."""

import numpy as np
import pytest

from mbkf.filters.pose_errors import LOOSE, PoseErrors
from mbkf.model.scale_derivatives import OriginLevers
from mbkf.sensors.flexed_skin import FlexedSkin
from tests.motions import assert_near, moderate_pose, protocol_sensor, random_model

COLUMNS = 7


def by_markers(sensor, noise_m, root, skin, q):
    """(nv, r) −(Hᵀ R⁻¹ H + Π)⁻¹ Hᵀ R⁻¹ δ with the errors δ (3 M, r) of all markers."""
    model, origins = sensor.model, OriginLevers(sensor.model)
    levers = np.concatenate([origins.levers, origins.centre_levers], axis=2)
    sizes, places = root[: levers.shape[2]], root[levers.shape[2] :]
    places = places.reshape(-1, len(noise_m), 3, root.shape[1])
    local = places[0] + np.einsum("md,dmir->mir", skin.shares(q), places[1:]) if skin else places[0]
    rotations, _ = model.placements(q)
    away = rotations[sensor.joint_ids] @ local
    away += origins.summed(rotations, levers, sensor.joint_ids) @ sizes
    H, weight = sensor.reading(q).jacobian.reshape(-1, model.nv), np.repeat(noise_m**-2.0, 3)[:, None]
    sd = np.where(model.posture_sd > 0.0, model.posture_sd, np.inf)
    information = H.T @ (weight * H) + np.diag(LOOSE + sd**-2.0)
    return -np.linalg.solve(information, H.T @ (weight * away.reshape(len(H), -1)))


@pytest.fixture(scope="module", params=[True, False], ids=["skin", "rigid"])
def made(request):
    """Markers, some of which a network places, with a random root, and poses."""
    rng = np.random.default_rng(8)
    model = random_model(rng)
    sensor, names = protocol_sensor(model)
    noise_m = rng.uniform(0.003, 0.015, len(names))
    segments = ["" if n % 4 == 0 else segment for n, segment in enumerate(sensor.segments)]
    skin = FlexedSkin(model, segments) if request.param else None
    origins = OriginLevers(model)
    rows = origins.levers.shape[2] + origins.centre_levers.shape[2]
    rows += 3 * len(names) * (1 + (skin.flexions if skin else 0))
    root = 0.01 * rng.normal(size=(rows, COLUMNS))
    poses = np.array([moderate_pose(model, rng, spread=0.6) for _ in range(3)])
    return sensor, noise_m, root, skin, poses


def test_roots_are_those_of_all_markers_one_by_one(made):
    *known, poses = made
    for found, q in zip(PoseErrors(*known).roots(poses), poses, strict=True):
        expected = by_markers(*known, q)
        assert_near(found / np.abs(expected).max(), expected / np.abs(expected).max(), 1e-9)


def test_directions_combine_columns(made):
    sensor, noise_m, root, skin, poses = made
    directions = np.random.default_rng(1).normal(size=(COLUMNS, 3))
    fewer, combined = (
        PoseErrors(sensor, noise_m, root, skin),
        PoseErrors(sensor, noise_m, root @ directions, skin),
    )
    fewer.onto(directions)
    assert_near(fewer.sizes, combined.sizes, 1e-15)
    assert_near(fewer.roots(poses[:1])[0], combined.roots(poses[:1])[0], 1e-12)


@pytest.mark.parametrize("narrower", [1.0, 0.35])
def test_a_joint_that_is_held_otherwise_is_drawn_to_neutral_as_far_as_markers_let_it(made, narrower):
    """The fitted pose errs by (Hᵀ R⁻¹ H + Π)⁻¹ Π h: of the trunk, which many markers show, by a small part of h.

    Π is that of the prior that was used.
    """
    sensor, noise_m, root, skin, poses = made
    model, q = sensor.model, poses[0]
    held_rad = np.where(model.posture_sd > 0.0, 0.1, 0.0)
    used_rad = narrower * model.posture_sd
    found = PoseErrors(sensor, noise_m, root, skin, held_rad, used_rad).roots(poses[:1])[0]
    alone = PoseErrors(sensor, noise_m, root, skin, None, used_rad).roots(poses[:1])[0]
    assert_near(found[:, :COLUMNS], alone, 1e-12)
    H, weight = sensor.reading(q).jacobian.reshape(-1, model.nv), np.repeat(noise_m**-2.0, 3)[:, None]
    prior = np.where(model.posture_sd > 0.0, used_rad, np.inf) ** -2.0
    pulled = np.linalg.solve(H.T @ (weight * H) + np.diag(LOOSE + prior), np.diag(prior * held_rad))
    assert_near(-found[:, COLUMNS:], pulled[:, held_rad > 0.0], 1e-9)
    spread = np.sqrt((found[:, COLUMNS:] ** 2).sum(axis=1))
    assert (spread[model.joint("torso").v] < 0.02 / narrower**2).all()


def test_a_pose_that_is_not_determined_is_refused(made):
    sensor, noise_m, root, skin, poses = made
    errors = PoseErrors(sensor, noise_m, root, skin)
    errors._prior = np.full(sensor.model.nv, -1e12)
    with pytest.raises(np.linalg.LinAlgError, match="do not determine"):
        errors.roots(poses[:1])
