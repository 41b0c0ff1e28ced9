"""Corresponding markers of both sides."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.model.protocol import load_protocol
from mbkf.scaling.partners import partners


def by_name(markers):
    names = [marker.name for marker in markers]
    return {
        name: names[other]
        for name, other in zip(names, partners(markers), strict=True)
        if names[other] != name
    }


@pytest.mark.parametrize(
    ("protocol", "pairs"),
    [
        ("reference36", {"RKNE": "LKNE", "LHEE": "RHEE"}),
        ("rajagopal_walk", {"R.SH1": "L.SH1", "L.MKnee": "R.MKnee"}),  # clusters are no mirror images
        ("opencap_lab", {"r_knee": "L_knee"}),
    ],
)
def test_both_sides_correspond_by_their_names(protocol, pairs):
    found = by_name(load_protocol(protocol).markers)
    assert pairs.items() <= found.items()
    assert all(found[other] == name for name, other in found.items())


def test_markers_without_a_side_have_no_partner():
    markers = load_protocol("reference36").markers
    assert {"C7", "SACR"}.isdisjoint(by_name(markers))


def test_places_decide_where_names_do_not():
    markers = [replace(one, name=f"m{k:02d}") for k, one in enumerate(load_protocol("reference36").markers)]
    assert np.array_equal(partners(markers), partners(load_protocol("reference36").markers))
