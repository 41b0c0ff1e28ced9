"""What the labelling benchmark says of a capture whose labels nobody knows."""

import math

import numpy as np

from benchmarks.labelling.any_attitude import LEAP_M, in_order, kept_shares
from mbkf.io.records import MarkerTrajectories
from mbkf.io.subject import Subject, SubjectMarker
from mbkf.labelling.assignment import HIDDEN

PLACES = {
    "RTHPA": (0.05, -0.11, 0.07),
    "RTHPP": (-0.01, -0.11, 0.08),
    "RTHDP": (-0.01, -0.18, 0.07),
    "RTHDA": (0.05, -0.19, 0.07),
}
"""Forward, up, right: the axes of OpenSim's bodies."""


def markers(positions):
    names = tuple(f"*{k}" for k in range(positions.shape[1]))
    return MarkerTrajectories(names, positions, 100.0)


def test_shares_count_frames_of_the_commonest_label_and_none_is_one():
    labels = np.full((10, 2), 3)
    labels[:2, 0] = 5
    labels[:4, 1] = HIDDEN
    shares = kept_shares(markers(np.zeros((10, 2, 3))), labels, math.inf)
    assert np.allclose(shares, [80.0, 60.0])


def test_columns_are_cut_where_the_point_leaps_over_a_gap():
    positions = np.zeros((10, 1, 3))
    positions[6:] = 2.0 * LEAP_M
    labels = np.where(np.arange(10) < 6, 0, 1)[:, None]
    assert np.allclose(kept_shares(markers(positions), labels, LEAP_M), [60.0])
    positions[5] = np.nan
    assert np.allclose(kept_shares(markers(positions), labels, LEAP_M), [100.0, 100.0])
    assert np.allclose(kept_shares(markers(positions), labels, math.inf), [500.0 / 9.0])


def subject(places):
    own = tuple(
        SubjectMarker(name, "right_thigh", np.array([x + 0.02, 0.01 - right, up + 0.1]), 0.008, 0.03)
        for name, (x, up, right) in places.items()
    )
    report = {"markers": {name: {} for name in places}}
    return Subject("human18", 70.0, {}, own, "autolabel62", report=report)


def test_clusters_are_in_order_or_not(tmp_path):
    path = tmp_path / "set.xml"
    rows = [
        f'<Marker name="{name}"><location>{x} {y} {z}</location></Marker>'
        for name, (x, y, z) in PLACES.items()
    ]
    path.write_text(f"<MarkerSet>{''.join(rows)}</MarkerSet>", encoding="utf-8")
    assert in_order(subject(PLACES), path) == (1, 1)
    turned = dict(zip(PLACES, [*list(PLACES.values())[1:], PLACES["RTHPA"]], strict=True))
    assert in_order(subject(turned), path) == (0, 1)
