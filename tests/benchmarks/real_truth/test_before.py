"""Markers before: every capture of the file is one that both trees follow."""

import pytest

from benchmarks.equality.captures import CAPTURES, Captured
from benchmarks.real_truth.before import Task, before_rows, marker_rms_mm, stated

MARKERS = stated("marker_rms_mm")


def test_every_stated_capture_is_followed():
    assert set(MARKERS) <= {one.name for one in CAPTURES}
    assert min(MARKERS.values()) > 0.0


def test_rows_are_ratios_to_the_stated_values(tmp_path):
    def mapper(function, items):
        assert function is marker_rms_mm
        return [1.2 * MARKERS[one.capture.name] for one in items]

    rows = before_rows(tmp_path, tmp_path, mapper)
    assert [row.value for row in rows] == pytest.approx([1.2] * len(MARKERS))
    assert not any(row.passed for row in rows)


def test_a_command_that_fails_passes_no_bound(tmp_path):
    missing = Captured("missing", "{data}/missing.c3d", (("scale", "{data}/missing.c3d", "--mass", "70"),))
    value = marker_rms_mm(Task(missing, tmp_path, tmp_path / "out"))
    assert not value <= 1e9
