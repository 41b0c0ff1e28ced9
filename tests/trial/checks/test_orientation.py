"""Plates laid down otherwise than their file says are found and laid back; right ones are left alone."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.sensors.contact.plates import plate_wrenches
from mbkf.trial.checks.orientation import axes_findings, laid, place_findings, turned_with_room
from tests.checked import evidence, plates


def walked_on():
    """Plates of the walk on which somebody stands alone."""
    found, _ = axes_findings(evidence())
    return [p for p, one in enumerate(found) if one.verdict != "not judged"]


def test_right_plates_are_left_alone():
    found, same = axes_findings(evidence())
    assert walked_on()
    assert {one.verdict for one in found} <= {"inside", "not judged"}
    assert all(one is other for one, other in zip(same, plates(), strict=True))


@pytest.mark.parametrize(("quarters", "mirrored"), [(2, False), (1, False), (0, True), (2, True)])
def test_a_plate_laid_otherwise_is_found_and_laid_back(quarters, mirrored):
    read, p = list(plates()), walked_on()[1]
    read[p] = laid(read[p], quarters, mirrored)
    found, back = axes_findings(evidence(read=tuple(read)))
    assert [k for k, one in enumerate(found) if one.verdict == "outside"] == [p]
    assert f"'{read[p].name}'" in found[p].name
    np.testing.assert_allclose(back[p].force_n, plates()[p].force_n, atol=1e-9)
    np.testing.assert_allclose(back[p].moment_nm, plates()[p].moment_nm, atol=1e-9)


def test_a_wrong_mass_accuses_no_plate():
    found, _ = axes_findings(evidence(mass=1.3))
    assert "outside" not in {one.verdict for one in found}


def test_laying_a_plate_moves_its_centre_of_pressure_alike():
    """A force at a point of the plate acts at the point that the turn takes it to."""
    plate = plates()[0]
    turned = laid(plate, 2, False)
    loaded = ~np.isnan(plate.centre_of_pressure_m[:, 0])
    sum_of_both = plate.centre_of_pressure_m[loaded, :2] + turned.centre_of_pressure_m[loaded, :2]
    np.testing.assert_allclose(sum_of_both, 2.0 * plate.origin_m[None, :2] + 0.0 * sum_of_both, atol=1e-9)
    for way in ((1, False), (0, True), (3, True)):
        other = laid(plate, *way)
        arm = other.centre_of_pressure_m - other.origin_m
        moment = np.cross(arm, other.force_n)[loaded]
        np.testing.assert_allclose(other.moment_nm[loaded, :2], moment[:, :2], atol=0.5)


@pytest.mark.parametrize("way", [(1, False), (2, True)])
def test_a_plate_beside_a_corrected_one_is_judged_by_its_corrected_readings(way):
    """Wrenches mapped frame by frame are those that readings laid down otherwise give."""
    given = evidence()
    turned = [laid(one, *way) for one in plates()]
    found, back = axes_findings(evidence(read=(turned[0], turned[1], *plates()[2:])))
    assert "outside" in {one.verdict for one in found}
    again = evidence(read=back)
    np.testing.assert_allclose(again.raw, given.raw, atol=1e-9)


def test_four_quarter_turns_are_none():
    plate = plates()[0]
    around = plate
    for _ in range(4):
        around = laid(around, 1, False)
    np.testing.assert_allclose(around.force_n, plate.force_n, atol=1e-9)
    np.testing.assert_allclose(laid(laid(plate, 0, True), 0, True).moment_nm, plate.moment_nm, atol=1e-9)


def test_a_plate_beside_its_place_is_found():
    read, p = list(plates()), walked_on()[1]
    read[p] = replace(read[p], origin_m=read[p].origin_m + np.array([0.08, -0.06, 0.0]))
    found = place_findings(evidence(read=tuple(read)))
    assert found[p].value == pytest.approx(100.0, abs=15.0)
    assert found[p].verdict == "outside"
    along = float(found[p].hint.split()[4])
    assert along == pytest.approx(-80.0, abs=15.0), "it lies back along x"
    assert {one.verdict for k, one in enumerate(place_findings(evidence()))} <= {"inside", "not judged"}


def test_frames_count_in_which_plates_carry_all():
    given = evidence()
    half = replace(
        given, given=np.where((np.arange(len(given.times_s)) < 50)[:, None, None], 0.4, 1.0) * given.given
    )
    assert given.carried[10:40].all()
    assert not half.carried[:40].any()


@pytest.mark.parametrize("quarters", [1, 3])
def test_plates_that_share_the_load_all_along_are_found_where_all_lie_alike(quarters):
    """In a squat no plate carries most of the load: one corrected beside the other, which is wrong, fits no better."""
    right = plates("squat")
    found, back = axes_findings(evidence("squat", read=tuple(laid(one, quarters, False) for one in right)))
    assert [one.name for one in found if one.verdict == "outside"] == ["axes of all plates"]
    assert f"turned by {360 - 90 * quarters}°" in found[-1].hint
    for one, other in zip(back, right, strict=True):
        np.testing.assert_allclose(one.force_n, other.force_n, atol=1e-9)


def test_right_plates_under_a_squat_are_left_alone():
    found, same = axes_findings(evidence("squat"))
    assert "outside" not in {one.verdict for one in found}
    assert all(one is other for one, other in zip(same, plates("squat"), strict=True))


@pytest.mark.parametrize("quarters", [1, 2, 3])
def test_markers_turned_against_the_plates_are_found_in_a_squat(quarters):
    """The plates lie and push as in another room, which is turned about the vertical through its origin."""
    by = np.array([0.3, 0.2, 0.0])
    away = tuple(
        replace(one, origin_m=one.origin_m + by, centre_of_pressure_m=one.centre_of_pressure_m + by)
        for one in plates("squat")
    )
    given = evidence("squat")
    motion = replace(given, asked=given.gives(away).sum(axis=1))
    read = tuple(turned_with_room(one, quarters) for one in away)
    raw = plate_wrenches(read, motion.times_s, motion.rate_hz)
    found, back = axes_findings(replace(motion, plates=read, given=motion.averaged(raw), raw=raw))
    outside = [one for one in found if one.verdict == "outside"][-1]
    assert outside.name == "axes of all plates" and "laboratory's origin" in outside.hint
    for one, again in zip(away, back, strict=True):
        np.testing.assert_allclose(again.origin_m, one.origin_m, atol=1e-9)
        np.testing.assert_allclose(again.moment_nm, one.moment_nm, atol=1e-9)
        np.testing.assert_allclose(again.force_n, one.force_n, atol=1e-9)


def test_plates_that_share_the_load_are_found_where_all_lie_elsewhere():
    by = np.array([0.08, -0.06, 0.0])
    read = tuple(replace(one, origin_m=one.origin_m + by) for one in plates("squat"))
    *single, together = place_findings(evidence("squat", read=read))
    assert {one.verdict for one in single} == {"not judged"}
    assert together.name == "place of all plates" and together.verdict == "outside"
    assert together.value == pytest.approx(100.0, abs=15.0)
    assert len(place_findings(evidence("squat"))) == len(single)
