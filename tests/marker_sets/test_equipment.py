"""Sets of segments that carry markers: shares, and heights on the reference body."""

import numpy as np
import pytest

from mbkf.marker_sets.equipment import EQUIPMENTS, equipped_weight
from mbkf.marker_sets.places import worn_places
from mbkf.model.body_file import load_body
from mbkf.model.human import HumanModel
from mbkf.model.protocol import load_protocol, protocol_names
from mbkf.sensors.contact.soles import sole_points
from mbkf.sensors.marker_sensor import MarkerSensor

PLACES = worn_places(load_body())

each = pytest.mark.parametrize("equipment", EQUIPMENTS, ids=lambda one: one.name)


def test_shares_are_probabilities():
    assert sum(one.share for one in EQUIPMENTS) == pytest.approx(1.0)
    assert all(one.share > 0.0 for one in EQUIPMENTS)
    assert len({one.name for one in EQUIPMENTS}) == len(EQUIPMENTS)


@each
def test_bare_segments_have_no_share_and_the_others_keep_their_ratios(equipment):
    weight = equipped_weight(PLACES, equipment)
    assert weight.sum() == pytest.approx(1.0, abs=1e-12)
    bare = np.array([segment.endswith(equipment.without) for segment in PLACES.segments])
    assert (weight[bare] == 0.0).all()
    kept = ~bare & (PLACES.weight > 0.0)
    ratio = weight[kept] / PLACES.weight[kept]
    np.testing.assert_allclose(ratio, ratio[0])
    assert ratio[0] >= 1.0


@each
def test_heights_are_those_of_markers_on_the_standing_body(equipment):
    """Of the shipped protocols that equip its outermost segments, in the median."""
    model = HumanModel.scaled()
    q = model.neutral()
    q[2] -= sole_points(model, q[None])[0, :, :, 2].min()
    highest, lowest = [], []
    for protocol in map(load_protocol, protocol_names()):
        if not any(m.segment == "right_hand" for m in protocol.markers):
            continue
        bare = equipment.without or ("-",)
        worn = [m for m in protocol.markers if m.kind != "computed" and not m.segment.endswith(bare)]
        sensor = MarkerSensor(model, [m.segment for m in worn], np.array([m.position_m for m in worn]))
        height = sensor.positions(q)[:, 2]
        highest.append(height.max())
        lowest.append(height.min())
    assert min(abs(np.median(highest) - top) for top in equipment.top_m) < 0.08
    assert np.median(lowest) == pytest.approx(equipment.bottom_m, abs=0.08)
