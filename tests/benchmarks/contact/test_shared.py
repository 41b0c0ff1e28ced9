"""The rows of shared plates: what they count, and that feet which are not shared, or shared wrongly, fail them."""

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.checks import Context
from benchmarks.contact import shared
from benchmarks.contact.shared import STANDING, Errors, errors, moved_back, shared_rows
from mbkf.sensors.contact.records import Contact

WEIGHT_N = 700.0


def reconstruction(wrench, sd_n=10.0, contact=Contact.SHARED):
    """What a filter found."""
    sd = np.full(wrench.shape, sd_n)
    return SimpleNamespace(
        foot_wrench=wrench, foot_wrench_sd=sd, foot_contact=np.full(wrench.shape[:2], contact)
    )


def test_errors_count_vertical_forces_of_feet_that_bear():
    true, bears = np.zeros((4, 2, 6)), np.array([[1, 1], [1, 0], [0, 0], [1, 1]], dtype=bool)
    found = true.copy()
    found[:, :, 2] = 7.0
    found[2] = found[1, 1] = 1000.0
    found[:, :, 0] = 300.0
    off = errors(reconstruction(found), true, bears, WEIGHT_N)
    assert off.double_percent == pytest.approx(1.0) and off.stance_percent == pytest.approx(1.0)
    assert off.spread == pytest.approx(0.7) and off.unshared == 0
    assert errors(reconstruction(found, contact=Contact.MEASURED), true, bears, WEIGHT_N).unshared == 2


def test_a_belt_moves_wrenches_as_it_moves_their_points():
    rng, times = np.random.default_rng(0), np.linspace(0.0, 1.0, 5)
    points, forces = rng.normal(size=(5, 2, 3)), rng.normal(size=(5, 2, 3))
    wrench = np.concatenate([forces, np.cross(points, forces)], axis=2)
    points[:, :, 0] -= 1.5 * times[:, None]
    expected = np.concatenate([forces, np.cross(points, forces)], axis=2)
    np.testing.assert_allclose(moved_back(wrench, times, 1.5), expected, atol=1e-12)


@pytest.mark.parametrize(("percent", "over_sd"), [(3.0, 1.0), (11.0, 1.0), (3.0, 1.6), (3.0, 0.3)])
def test_standing_fails_by_force_and_by_spread(monkeypatch, tmp_path, percent, over_sd):
    off = Errors(
        np.full((3, 2), 0.01 * percent * WEIGHT_N), np.zeros(1), np.full((3, 2), over_sd), 0, WEIGHT_N
    )
    monkeypatch.setattr(shared, "_standing", lambda *_: off)
    monkeypatch.setattr(shared, "_walk_rows", lambda _: [])
    rows = shared_rows(Context(None, tmp_path, quick=True))
    forces = [row for row in rows if row.name.endswith("force per foot")]
    assert len(forces) == 2 * 2 * len(STANDING)
    assert [row.passed for row in forces] == [percent <= row.bound for row in forces]
    spreads = [row for row in rows if "over stated sd" in row.name]
    assert any(row.name.startswith("shared, all captures") for row in spreads)
    assert all(row.passed for row in spreads) == (0.7 <= over_sd <= 1.3)


@pytest.mark.slow
def test_a_real_walk_over_one_plate_keeps_its_bounds(monkeypatch, real_data):
    monkeypatch.setattr(shared, "REAL_WALKS", {"HC044A": shared.REAL_WALKS["HC044A"]})
    monkeypatch.setattr(shared, "PASSES", {"causal": False})
    spreads = {"causal": []}
    rows = list(shared._real_rows(real_data, spreads))
    assert len(rows) == 5 and len(spreads["causal"]) == 1
    assert [row.name for row in rows if not row.passed] == []
