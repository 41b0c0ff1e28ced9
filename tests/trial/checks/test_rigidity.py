"""Markers of one segment against each other: the one that moves is named, a turning body moves none."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.trial.checks.rigidity import rigidity_finding
from tests.checked import recorded
from tests.dynamics import trial


def markers():
    subject = trial("walk").subject
    names = {marker.name for marker in subject.markers}
    read = recorded().markers
    return read.select(tuple(name for name in read.names if name in names)), subject


def test_markers_on_a_walking_body_stay():
    read, subject = markers()
    found = rigidity_finding(read, subject)
    assert found.verdict == "inside"
    assert found.value < 5.0, "cameras' noise of 1 mm, and joints inside a segment's markers none"


def test_a_marker_that_slides_is_named():
    read, subject = markers()
    assert rigidity_finding(read, subject).verdict == "inside"
    own = [m.segment for m in subject.markers]
    name = next(m.name for m in subject.markers if own.count(m.segment) >= 4 and m.name in read.names)
    moved = read.positions_m.copy()
    slide = 0.15 * np.sin(np.linspace(0.0, 20.0, read.frames))
    moved[:, read.names.index(name)] += slide[:, None] * np.array([0.6, 0.64, 0.48])
    found = rigidity_finding(replace(read, positions_m=moved), subject)
    assert found.hint.startswith(f"{name} moves most")
    assert found.verdict == "outside"


def test_the_spread_is_that_of_the_distance():
    read, subject = markers()
    pair = [m.name for m in subject.markers if m.segment == "right_shank"][:2]
    two = read.select(tuple(pair))
    rng = np.random.default_rng(0)
    still = np.zeros_like(two.positions_m)
    still[:, 1, 0] = 0.4 + 0.05 * rng.normal(size=two.frames)
    found = rigidity_finding(replace(two, positions_m=still), subject)
    assert found.value == pytest.approx(50.0, rel=0.15)


def test_one_marker_on_each_segment_is_not_judged():
    read, subject = markers()
    first = {m.segment: m.name for m in subject.markers if m.name in read.names}
    assert rigidity_finding(read.select(tuple(first.values())), subject).verdict == "not judged"
