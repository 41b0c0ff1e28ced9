"""Exchanged names of a standing trial, found by the cost of scaling."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.model.protocol import load_protocol
from mbkf.scaling import standing_names
from mbkf.scaling.standing_names import likeliest_names
from tests.motions import capture_of, marker_positions, protocol_sensor, random_model

MODEL = random_model(np.random.default_rng(5), spread=0.04)


def standing(protocol, keep=None):
    """A person who stands nearly straight, markers some millimetres beside their places."""
    rng = np.random.default_rng(6)
    known = [m.name for m in load_protocol(protocol).markers if m.kind != "computed"]
    sensor, names = protocol_sensor(MODEL, protocol, keep=known)
    q = MODEL.integrate(
        MODEL.neutral(), np.r_[np.zeros(6), np.deg2rad(4.0) * rng.standard_normal(MODEL.nv - 6)]
    )
    places = marker_positions(sensor, [q])
    return capture_of(names, places + 0.004 * rng.standard_normal(places.shape)).markers


def crossed(markers, *pairs):
    names = list(markers.names)
    for a, b in pairs:
        i, j = names.index(a), names.index(b)
        names[i], names[j] = names[j], names[i]
    return replace(markers, names=tuple(names))


def undone(markers, exchanges):
    return crossed(markers, *exchanges[::-1]).names


LEGS = [(f"R{one}", f"L{one}") for one in ("THI", "KNE", "TUB", "ANK", "HEE", "MID", "MT1", "MT5", "HAL")]
CASES = {
    "knees of both sides": ("reference36", [("RKNE", "LKNE")]),
    "knee and ankle": ("reference36", [("RKNE", "RANK")]),
    "whole legs": ("reference36", LEGS),
    "a part of both legs": ("reference36", [LEGS[k] for k in (1, 2, 3, 4)]),
    "inner and outer knee": ("rajagopal_walk", [("R.Knee", "R.MKnee")]),
    "inner and outer elbows": ("rajagopal_walk", [("R.Elbow", "R.MElbow"), ("L.Elbow", "L.MElbow")]),
    "front and back of the pelvis": ("plug_in_gait", [("RASI", "RPSI"), ("LASI", "LPSI")]),
}


@pytest.mark.parametrize(("protocol", "pairs"), CASES.values(), ids=CASES.keys())
def test_exchanged_names_are_found(protocol, pairs):
    right = standing(protocol)
    wrong = crossed(right, *pairs)
    found = likeliest_names(wrong, load_protocol(protocol))
    assert undone(wrong, found.exchanges) == right.names
    assert found.gain > 20.0
    assert found.misfit < 1.5 < found.before


@pytest.mark.parametrize("protocol", ["reference36", "rajagopal_walk", "plug_in_gait"])
def test_right_names_stay(protocol):
    found = likeliest_names(standing(protocol), load_protocol(protocol))
    assert (found.exchanges, found.gain) == ((), 0.0)
    assert found.misfit == found.before < 1.5


def test_a_ghost_takes_no_other_name():
    found = misplaced("RKNE")
    assert (found.exchanges, found.stray) == ((), True)
    assert found.worst[0] == "RKNE"


def test_markers_that_fit_no_person_are_named(monkeypatch):
    monkeypatch.setattr(standing_names, "ROUNDS", 1)  # to save time
    found = misplaced("RKNE", "LANK")
    assert (found.exchanges, found.stray) == ((), False)
    assert set(found.worst) == {"RKNE", "LANK"}
    assert found.misfit > 8.0


def misplaced(*names):
    """The names of a person with some markers half a metre too high."""
    right = standing("reference36")
    places = right.positions_m.copy()
    places[:, [right.names.index(one) for one in names]] += [0.0, 0.0, 0.5]
    return likeliest_names(replace(right, positions_m=places), load_protocol("reference36"))
