"""The body protocol: the model mbkf builds has every member that filters and sensors ask for."""

from pathlib import Path

import pytest

from mbkf.model.body import Body
from mbkf.model.human import HumanModel

LEGS = Path(__file__).resolve().parents[2] / "docs/examples/bodies/legs.toml"


@pytest.mark.parametrize("body", ["human18", LEGS], ids=["human18", "legs"])
def test_a_scaled_body_has_all_members(body):
    model = HumanModel.scaled(body=body)
    assert isinstance(model, Body)
    assert model.root is model.joints[model.roles.root]
    assert model.root.v == slice(0, 6)
    assert model.limits.shape == (model.nv, 2)
    assert model.supports.shape[1] == model.nv
    assert not isinstance(object(), Body)
