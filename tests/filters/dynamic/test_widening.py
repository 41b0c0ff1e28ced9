"""More states in an estimate: those that it has stay what they are, new ones begin as their block says."""

import numpy as np
import pytest

from mbkf.errors import UnknownName
from mbkf.filters.dynamic.widening import common_states, widened_state
from mbkf.model.layout import ExtraState, Layout
from mbkf.sensors.supports.block import Supports
from tests.dynamics import DT, RESIDUAL, random_state
from tests.followed import estimates, made, made_filter, recording
from tests.motions import reference_model

MODEL = reference_model()
NARROW = Layout.dynamic(MODEL.nv, RESIDUAL)
BIAS = ExtraState("bias", np.array([3.0, 4.0]), np.array([0.5, 0.7]), np.zeros(2))


@pytest.mark.parametrize("extras", [[BIAS, *RESIDUAL], [*RESIDUAL, BIAS]])
def test_mean_and_covariance_of_the_common_states_stay(extras):
    """Wherever the new states lie among those that blocks add."""
    wide, state = Layout.dynamic(MODEL.nv, extras), random_state(MODEL, np.random.default_rng(1))
    found = widened_state(state, NARROW, wide)
    common = common_states(NARROW, wide)
    np.testing.assert_array_equal(found.P[np.ix_(common, common)], state.P)
    for name in ("q", "v", "a", "w"):
        np.testing.assert_array_equal(getattr(found, name), getattr(state, name))
    np.testing.assert_array_equal(found.extra[wide.extra_index(RESIDUAL[0].name)], state.extra)
    np.testing.assert_array_equal(found.extra[wide.extra_index("bias")], BIAS.start)
    new = wide["bias"]
    np.testing.assert_array_equal(found.P[new, new], np.diag(BIAS.start_sd**2))
    assert not np.delete(found.P[new], np.arange(new.start, new.stop), axis=1).any()
    assert found.P.flags.f_contiguous


def test_a_layout_that_lacks_a_part_is_no_wider_one():
    with pytest.raises(UnknownName):
        common_states(NARROW, Layout.dynamic(MODEL.nv, [BIAS]))


def test_the_wide_filter_goes_on_as_the_narrow_one_would():
    """While nothing bears, its own states are closed and the body moves as before."""
    narrow, found = estimates("dynamic")
    wide = narrow.widened(found[20])
    assert narrow.widened(wide) is wide
    assert len(wide.record.state.P) == len(found[20].record.state.P) + 6
    kept = dict(zip(map(type, narrow.report_of(wide).kalman.blocks), wide.record.memory.blocks, strict=True))
    assert kept.pop(Supports) == ()
    for kind, memory in zip(map(type, narrow.kalman.blocks), found[20].record.memory.blocks, strict=True):
        assert kept[kind] is memory
    for t in (21, 22):
        wide = narrow.step(wide, recording(), t)
    off = made().model.difference(found[22].q, wide.q)
    np.testing.assert_allclose(off, 0.0, atol=1e-5)
    np.testing.assert_allclose(wide.wrench, found[22].wrench, atol=2.0)
    assert not wide.support.any() and np.isfinite(narrow.support_sd(wide)).all()
    np.testing.assert_allclose(narrow.spread(wide).position, narrow.spread(found[22]).position, rtol=0.01)


def test_a_filter_that_knows_other_contacts_from_the_start_is_wide_already():
    filter = made_filter("dynamic", other_contacts=True)
    first = filter.start(recording(), 0, None)
    assert filter.widened(first) is first and filter.report_of(first) is filter.report
    assert filter.dt_s == DT
