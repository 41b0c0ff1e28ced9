"""All checks of a trial: each fault is told by the check that it belongs to, and right captures are left alone."""

import numpy as np
import pytest

from mbkf.io.findings import Finding
from mbkf.trial.checks import newton
from mbkf.trial.checks.clocks import delayed
from mbkf.trial.checks.judge import marker_checks, messages, plate_checks
from mbkf.trial.checks.orientation import laid
from tests.checked import amplified, body, motion, plates, recorded
from tests.dynamics import trial


def checked(name="walk", mass=1.0, read=None, others=None):
    markers = recorded(name).markers
    given = plates(name) if read is None else read
    found = plate_checks(body(name, mass), motion(name), markers.times_s, markers.rate_hz, given, others)
    return {one.name: one for one in found}


def outside(found):
    consequences = (newton.FORCE, newton.MOMENT)
    return {name for name, one in found.items() if one.verdict == "outside" and name not in consequences}


@pytest.mark.parametrize("name", ["walk", "squat"])
def test_nothing_is_wrong_with_a_true_trial(name):
    assert {one.verdict for one in checked(name).values()} <= {"inside", "not judged"}


def test_each_fault_is_told_once():
    read = plates()
    assert outside(checked(mass=1.3)) == {"mass against plates"}
    assert outside(checked(read=delayed(read, 0.04))) == {"clocks of markers and plates"}
    middle = len(read) // 2
    turned = tuple(laid(plate, 2, False) if p == middle else plate for p, plate in enumerate(read))
    assert outside(checked(read=turned)) == {f"axes of plate '{read[middle].name}'"}
    gains = amplified(read, [1.1 if p == middle else 1.0 for p in range(len(read))])
    assert outside(checked(read=gains)) == {"plates against plates"}


def test_a_wrong_plate_that_looks_like_a_hand_is_a_wrong_plate():
    """Frames that a search calls other contacts count where gains explain everything."""
    read = plates()
    gains = amplified(read, [1.1 if p == len(read) // 2 else 1.0 for p in range(len(read))])
    everywhere = np.ones(recorded().markers.frames, dtype=bool)
    assert outside(checked(read=gains, others=everywhere)) == {"plates against plates"}


def test_without_plates_only_markers_are_checked():
    assert checked(read=()) == {}
    subject = trial("walk").subject
    found = marker_checks(recorded().markers.select(tuple(m.name for m in subject.markers)), subject)
    assert [one.verdict for one in found] == ["inside", "inside"]


def test_causes_are_told_and_consequences_where_there_is_none():
    cause = Finding("mass against plates", 30.0, 1.0, "%", 5.0, "outside", "weigh anew", 70.0)
    follows = Finding(newton.FORCE, 25.0, 3.0, "% BW", 10.0, "outside", "of markers alone")
    well = Finding("clocks", 1.0, 2.0, "ms", 8.0, "inside", "one clock")
    assert messages((cause, follows, well)) == (
        "mass against plates: +30 % (noise explains ± 2); weigh anew",
    )
    assert [line.partition(":")[0] for line in messages((follows, well))] == [newton.FORCE]
    assert messages((well,)) == ()
