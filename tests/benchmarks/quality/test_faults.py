"""The rows of the checks' benchmark: faults are what they say, and rows count what findings tell."""

import numpy as np

from benchmarks.quality import faults
from benchmarks.quality.faults import amplified, better, fault_rows, is_judged, number, outside
from benchmarks.quality.spoilt import KNOWN, SHOWN, Followed
from mbkf.io.findings import Finding, not_judged
from tests.checked import motion, plates, recorded
from tests.dynamics import trial

FOUND = (
    Finding("mass against plates", 30.0, 1.0, "%", 5.0, "outside", "", 70.0),
    Finding("axes of plate '1'", 0.3, 0.5, "times", 1.5, "inside"),
    not_judged("axes of plate '2'", "times", 1.5, "nobody stood there"),
)


def test_findings_are_read_by_their_names():
    assert outside(FOUND) == {"mass against plates"}
    assert better(FOUND) == 70.0
    assert number(FOUND, "axes of plate '1'") == 0.3
    assert np.isnan(number(FOUND, "axes of plate '2'"))


def test_plates_nobody_stands_on_are_not_spoilt():
    one = plates()[0]
    assert is_judged((Finding(f"axes of plate '{one.name}'", 0.3, 0.5, "times", 1.5, "inside"),), one)
    assert not is_judged((not_judged(f"axes of plate '{one.name}'", "times", 1.5, "why"),), one)


def test_a_gain_multiplies_the_whole_wrench():
    one = plates()[0]
    other = amplified(one, 1.1)
    np.testing.assert_allclose(other.force_n, 1.1 * one.force_n)
    np.testing.assert_allclose(other.moment_nm, 1.1 * one.moment_nm)


def test_a_true_squat_keeps_every_bound(monkeypatch):
    """With the fault of each kind that is the hardest to see."""
    monkeypatch.setattr(faults, "MASSES", (0.9, 1.1))
    monkeypatch.setattr(faults, "DELAYS_MS", (10.0,))
    monkeypatch.setattr(faults, "GAINS", (0.9,))
    subject = trial("squat").subject
    markers = recorded("squat").markers.select(tuple(m.name for m in subject.markers))
    one = Followed("squat", markers, subject, plates("squat"), motion("squat"))
    rows = list(fault_rows(one, bounded=True))
    assert [row.name for row in rows if not row.passed] == []
    assert sum(row.bounded for row in rows) >= 8
    found = one.judged()
    monkeypatch.setattr(Followed, "judged", lambda *_, **__: found)
    assert not any(row.bounded for row in fault_rows(one, bounded=False))


def test_no_capture_is_both_known_and_only_shown():
    assert not set(KNOWN) & set(SHOWN)
