"""The table of axes: nine ways to store a capture, and what counts as right."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.any_capture import axes
from benchmarks.any_capture.axes import CAPTURES, as_stored, axes_rows, is_right
from mbkf.errors import InvalidInput
from mbkf.io.records import AxesSource
from mbkf.io.turning import turned
from tests.captures import made_capture


def test_nine_ways_are_six_rotations_and_three_mirror_images():
    for usual in ("y", "z"):
        ways = dict(as_stored(usual))
        assert len(ways) == 9
        handed = [round(float(np.linalg.det(store))) for store in ways.values()]
        assert handed == [1] * 6 + [-1] * 3
        assert len({store.tobytes() for store in ways.values()}) == 9
        for store in ways.values():
            np.testing.assert_array_equal(store @ store.T, np.eye(3))


def test_two_c3d_and_three_trc_captures_are_judged():
    suffixes = sorted(one.trial.rsplit(".", 1)[1] for one in CAPTURES)
    assert suffixes == ["c3d", "c3d", "trc", "trc", "trc"]


def test_right_are_markers_and_forces_upright_in_any_heading():
    capture = made_capture(5)
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    assert is_right(capture, capture, np.eye(3))
    assert is_right(turned(capture, quarter, AxesSource.BODY), capture, quarter)
    assert not is_right(turned(capture, quarter, AxesSource.BODY), capture, np.eye(3))
    for wrong in (np.diag([1.0, -1.0, 1.0]), np.diag([1.0, -1.0, -1.0])):
        assert not is_right(turned(capture, wrong, AxesSource.BODY), capture, wrong)
    pulled = replace(capture, plates=tuple(replace(p, force_n=-p.force_n) for p in capture.plates))
    assert not is_right(pulled, capture, np.eye(3))


def by_name(rows):
    return {row.name: row for row in rows}


@pytest.fixture
def one_capture(monkeypatch):
    monkeypatch.setattr(axes, "CAPTURES", CAPTURES[-1:])


@pytest.mark.usefixtures("one_capture")
def test_a_check_that_does_nothing_is_wrong_eight_times(real_data, monkeypatch):
    monkeypatch.setattr(axes, "right_axes", lambda captures, places: list(captures))
    rows = by_name(axes_rows(real_data))
    assert rows["axes, stoop lift: silently wrong of 9"].value == 8
    assert rows["axes: put right of 9"].value == 1
    assert not rows["axes: right or refused of 9"].passed
    assert not rows["axes, bmc lower walk: reflection found"].passed


@pytest.mark.usefixtures("one_capture")
def test_a_check_that_refuses_all_is_not_wrong(real_data, monkeypatch):
    def refuse(captures, places):
        if "lower" in captures[0].path:
            return [replace(captures[0])]
        raise InvalidInput("no")

    monkeypatch.setattr(axes, "right_axes", refuse)
    rows = by_name(axes_rows(real_data))
    assert rows["axes, stoop lift: refused of 9"].value == 9
    assert rows["axes: right or refused of 9"].passed


@pytest.mark.usefixtures("one_capture")
def test_the_check_puts_all_right(real_data):
    rows = by_name(axes_rows(real_data))
    assert rows["axes: put right of 9"].value == 9
    assert rows["axes, bmc lower walk: reflection found"].passed
