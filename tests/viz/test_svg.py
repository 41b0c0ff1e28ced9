"""Charts: every number inside the frame, gaps left open, extremes kept, ticks round."""

import re
from xml.etree import ElementTree as ET

import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st

from mbkf.viz.svg import BOTTOM, HEIGHT, LEFT, RIGHT, TOP, WIDTH, Line, Mark, chart, number, ticks

T = np.linspace(0.0, 2.0, 201)


def paths(svg, kind):
    return [e.attrib["d"] for e in ET.fromstring(svg).iter("path") if kind in e.attrib["class"].split()]


def points(d):
    """Points of a path of relative steps in tenths."""
    found = []
    for stretch in d.split("M")[1:]:
        steps = np.array([int(x) for x in re.findall(r"-?\d+", stretch)]).reshape(-1, 2)
        found.append(np.cumsum(steps, axis=0) / 10.0)
    return np.concatenate(found)


@given(st.floats(-1e4, 1e4), st.floats(1e-3, 1e4), st.integers(2, 10))
@example(1.0, 401.0, 2)
def test_ticks_are_round_and_inside(low, span, wanted):
    found, digits = ticks(low, low + span, wanted)
    assert 1 <= len(found) <= 2 * wanted + 1 or span / wanted < 1e-9
    slack = 1e-6 * span
    assert all(low - slack <= value <= low + span + slack for value in found)
    texts = [number(value, digits) for value in found]
    assert len(set(texts)) == len(texts), "two ticks that read alike"


def test_numbers_have_a_minus_and_no_negative_zero():
    assert number(-0.04, 1) == "0.0"
    assert number(-1.25, 2) == "−1.25"


def test_everything_is_drawn_inside_the_frame():
    y = 3.0 * np.sin(9.0 * T)
    sd = np.where(T > 1.8, 50.0, 0.1)
    svg = chart(
        "A & B", "°", [Line(T, y, sd, "r")], (0.0, 2.0), "s", marks=[Mark(1.0, "l"), Mark(9.0)], level=1.0
    )
    (line,), (band,), marks = paths(svg, "line"), paths(svg, "band"), paths(svg, "mark")
    for d in (line, band):
        x, y_ = points(d).T
        assert x.min() >= LEFT - 0.1 and x.max() <= WIDTH - RIGHT + 0.1
        assert y_.min() >= TOP - 0.1 and y_.max() <= HEIGHT - BOTTOM + 0.1
    assert np.ptp(points(line)[:, 1]) > 30.0, "a few wild bands do not flatten the curve"
    assert len(marks) == 1, "a mark outside the range is not drawn"
    assert "A &amp; B" in svg


def test_higher_values_stand_higher_and_time_runs_to_the_right():
    svg = chart("A", "", [Line(T, T)], (0.0, 2.0), "s")
    x, y = points(paths(svg, "line")[0]).T
    assert (np.diff(x) > 0).all() and (np.diff(y) <= 0).all()


def test_gaps_stay_open():
    y = np.where((T > 0.5) & (T < 1.0), np.nan, T)
    (line,) = paths(chart("A", "", [Line(T, y, 0.1 + 0 * T)], (0.0, 2.0), "s"), "line")
    assert line.count("M") == 2
    x = points(line)[:, 0]
    scale = (WIDTH - LEFT - RIGHT) / 2.0
    assert not ((x > LEFT + 0.55 * scale) & (x < LEFT + 0.95 * scale)).any()


def test_long_curves_are_thinned_and_keep_their_peaks():
    t = np.linspace(0.0, 2.0, 20_000)
    y = np.zeros(len(t))
    y[12_345] = 7.0
    svg = chart("A", "", [Line(t, y)], (0.0, 2.0), "s")
    (line,) = paths(svg, "line")
    assert len(points(line)) < 2.1 * WIDTH
    assert np.ptp(points(line)[:, 1]) > 50.0


def test_nothing_known_is_an_empty_chart():
    nothing = np.full(len(T), np.nan)
    svg = chart("A", "", [Line(T, nothing, nothing)], (0.0, 2.0), "s")
    assert paths(svg, "line") == [] and paths(svg, "band") == []
    assert "A" in svg
