"""The filters' states have what blocks ask of them."""

import inspect

import pytest

from mbkf.filters.dynamic.plant import DynamicState
from mbkf.filters.torque.plant import ForcedState
from mbkf.sensors.states import AcceleratedState, ForceState, LoadedState


@pytest.mark.parametrize(
    ("state", "asked"),
    [(DynamicState, AcceleratedState), (DynamicState, LoadedState), (ForcedState, ForceState)],
)
def test_a_filters_state_has_what_blocks_ask_of_it(state, asked):
    names = {name for name, _ in inspect.getmembers(asked, lambda one: isinstance(one, property))}
    assert names <= {*state.__dataclass_fields__, *dir(state)}
    assert {"q", "v", "P"} < names
