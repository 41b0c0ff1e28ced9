"""Marker by frame: each state where it happened, errors and gaps as the result has them."""

from xml.etree import ElementTree as ET

import numpy as np
import pytest

from mbkf.trial.results.summary import summarise
from mbkf.viz.report.marker_chart import (
    CHART,
    HIDDEN,
    LOST,
    NAME,
    REFUSED,
    SEEN,
    UNSEEN,
    longest_gap_s,
    marker_chart,
    marker_errors_mm,
    states,
)
from tests.motions import assert_near
from tests.recordings import LOST as LOST_FRAMES
from tests.recordings import broken_walk


def rects(svg, kind):
    return [e.attrib for e in ET.fromstring(svg).iter("rect") if e.attrib["class"] == kind]


def test_states():
    found = states(broken_walk())
    assert (found[20:50, 0] == UNSEEN).all() and (found[30:40, 1] == HIDDEN).all()
    assert (found[60:65, 2] == REFUSED).all() and (found[LOST_FRAMES] == LOST).all()
    assert found[70, 0] == SEEN


def test_errors_are_those_of_the_summary():
    r = broken_walk()
    rms, largest = marker_errors_mm(r)
    summary = summarise(r)
    assert_near(rms, [summary["marker_rms_mm_by_name"][name] for name in r.marker_names], 1e-9)
    assert largest.max() == pytest.approx(summary["marker_max_mm"])


def test_longest_gap():
    gap = longest_gap_s(broken_walk())
    assert_near(gap[:3], [0.30, 0.10, 0.0], 1e-12)


def test_stretches_are_drawn_where_they_happened():
    r = broken_walk()
    svg = marker_chart(r)
    (unseen,) = rects(svg, "unseen")
    scale = CHART / r.frames
    assert float(unseen["x"]) == pytest.approx(NAME + 20 * scale, abs=0.1)
    assert float(unseen["width"]) == pytest.approx(30 * scale, abs=0.1)
    assert len(rects(svg, "hidden")) == len(rects(svg, "refused")) == 1
    assert len(rects(svg, "lost")) == len(r.marker_names)
    assert all(name in svg for name in r.marker_names)


def test_ghosts_stand_above_the_markers():
    r = broken_walk()
    ghosts = np.zeros(r.frames)
    ghosts[10:20] = 3
    svg = marker_chart(r, ghosts)
    assert "at most 3 a frame, 30 in all" in svg
    assert "ghosts" not in marker_chart(r)
