"""Plates against a person's weight before a body is scaled: wrong masses and plates are reported, right ones never."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.trial.checks.unscaled_mass import plate_notes, stated_mass_notes, unscaled_mass_finding
from tests.checked import amplified, body, plates, recorded

UP = np.array([0.0, 0.0, 1.0])


def capture(name="walk", gain=1.0, offset_n=0.0, stated=1.0):
    """A trial whose plates read wrongly by a gain and an offset."""
    read = amplified(recorded(name).plates, [gain] * len(recorded(name).plates))
    moved = tuple(replace(plate, force_n=plate.force_n + offset_n * UP) for plate in read)
    mass_kg = None if stated is None else stated * body(name).mass_kg
    return Capture("trial.c3d", recorded(name).markers, moved, subject_mass_kg=mass_kg)


@pytest.mark.parametrize("name", ["walk", "squat"])
@pytest.mark.parametrize("wrong", [0.85, 1.0, 1.15])
def test_the_mass_is_that_of_the_body_whatever_is_stated(name, wrong):
    found = unscaled_mass_finding(capture(name, stated=wrong))
    assert found.better == pytest.approx(body(name).mass_kg, rel=0.02)
    assert found.value == pytest.approx(100.0 * (wrong - 1.0), abs=2.0)
    assert found.verdict == ("inside" if wrong == 1.0 else "outside")


def test_a_given_mass_counts_instead_of_that_of_the_file():
    assert unscaled_mass_finding(capture(stated=1.5), body().mass_kg).verdict == "inside"
    (note,) = plate_notes([capture()], 1.2 * body().mass_kg)
    assert "16 % less" in note and "units, gains and offsets" in note
    first, second = plate_notes([capture(), capture("squat")], 100.0)
    assert first.startswith("trial.c3d: the plates carry") and second.startswith("trial.c3d: ")


@pytest.mark.parametrize(("gain", "verdict"), [(1.0, "inside"), (10.0, "outside"), (0.05, "outside")])
def test_without_a_stated_mass_that_of_the_plates_has_to_be_a_person_s(gain, verdict):
    found = unscaled_mass_finding(capture("squat", gain=gain, stated=None))
    assert (found.verdict, found.value) == (verdict, None)
    assert ("not a person's weight" in found.hint) == (verdict == "outside")


@pytest.mark.parametrize("stated", [None, 1.0])
def test_an_offset_of_tons_is_reported_though_no_foot_is_seen(stated):
    """As of samples without a sign that are read with one."""
    wrong = capture("squat", offset_n=2900.0, stated=stated)
    high = wrong.markers.positions_m[:, :, 2].mean(axis=0) > 0.5
    names = tuple(name for name, kept in zip(wrong.markers.names, high, strict=True) if kept)
    wrong = replace(wrong, markers=wrong.markers.select(names))
    found = unscaled_mass_finding(wrong)
    assert found.verdict == "outside" and "on average" in found.hint
    right = replace(capture("squat", stated=stated), markers=wrong.markers)
    assert unscaled_mass_finding(right).verdict == "not judged"


def test_feet_beside_the_plates_accuse_nobody():
    """One foot on the only plate that was read: half of the weight, of which nothing follows."""
    whole = capture("squat")
    fullest = sorted(whole.plates, key=lambda plate: -plate.force_n[:, 2].mean())
    assert len([one for one in fullest if one.force_n[:, 2].mean() > 100.0]) == 2
    assert unscaled_mass_finding(replace(whole, plates=(fullest[0],))).verdict == "not judged"


def test_a_foot_that_is_not_seen_accuses_nobody():
    whole = capture("squat")
    low = whole.markers.positions_m[:, :, 2].min(axis=0) < 0.15
    positions = whole.markers.positions_m.copy()
    positions[30:, np.flatnonzero(low)[0]] = np.nan
    markers = replace(whole.markers, positions_m=positions)
    assert unscaled_mass_finding(replace(whole, markers=markers)).verdict == "not judged"


def test_sets_without_corners_are_weighed_where_feet_are_near_the_pressure():
    bare = tuple(replace(plate, corners_m=None) for plate in capture().plates)
    found = unscaled_mass_finding(replace(capture(), plates=bare))
    assert found.better == pytest.approx(body().mass_kg, rel=0.03)
    far = tuple(replace(plate, centre_of_pressure_m=plate.centre_of_pressure_m + 3.0) for plate in bare)
    assert unscaled_mass_finding(replace(capture(), plates=far)).better is None


@pytest.mark.parametrize("frames", [0, 1, 2, 20])
def test_too_little_is_not_judged(frames):
    markers = recorded().markers
    short = MarkerTrajectories(markers.names, markers.positions_m[:frames], markers.rate_hz)
    assert unscaled_mass_finding(replace(capture(), markers=short)).verdict == "not judged"
    assert unscaled_mass_finding(replace(capture(), plates=())).verdict == "not judged"
    assert plate_notes([replace(capture(), plates=())]) == []


def test_a_moving_plateload_of_one_second_hides_no_weight():
    """The law holds over less than a cycle: the rise of the body counts."""
    whole = capture("squat")
    frames = int(1.2 * whole.markers.rate_hz)
    for start in range(0, whole.markers.frames - frames, frames // 2):
        part = replace(
            whole.markers,
            positions_m=whole.markers.positions_m[start : start + frames],
            start_time_s=float(whole.markers.times_s[start]),
        )
        found = unscaled_mass_finding(replace(whole, markers=part))
        assert found.verdict in ("inside", "not judged", "doubtful")


def test_plates_that_were_recorded_for_a_part_only():
    whole = capture("squat")
    cut = tuple(
        replace(
            plate,
            force_n=plate.force_n[: len(plate.force_n) // 2],
            moment_nm=plate.moment_nm[: len(plate.force_n) // 2],
            centre_of_pressure_m=plate.centre_of_pressure_m[: len(plate.force_n) // 2],
        )
        for plate in plates("squat")
    )
    found = unscaled_mass_finding(replace(whole, plates=cut))
    assert found.better == pytest.approx(body("squat").mass_kg, rel=0.03)


@pytest.mark.parametrize(("given", "words"), [(1.09, ""), (0.91, ""), (1.2, "20 % more"), (0.8, "20 % less")])
def test_a_mass_that_contradicts_the_files_own_is_reported(given, words):
    own = body().mass_kg
    notes = stated_mass_notes([capture(), capture("squat", stated=None)], given * own)
    assert len(notes) == bool(words)
    assert all(words in note and "trial.c3d states" in note and "--mass" in note for note in notes)
