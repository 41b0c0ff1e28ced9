"""The mass by the plates' impulse: found whatever the body was given, and never without enough to tell by."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.trial.checks.mass import SCALE_PERCENT, SPEED_SD_M_S, VerticalLoads, impulse_finding, mass_finding
from tests.checked import amplified, body, evidence, nothing, plates


@pytest.mark.parametrize("name", ["walk", "squat"])
@pytest.mark.parametrize("wrong", [0.75, 0.9, 1.0, 1.1, 1.3])
def test_the_mass_is_found_whatever_was_stated(name, wrong):
    given = evidence(name, mass=wrong)
    found = mass_finding(given, nothing(given))
    assert found.better == pytest.approx(body(name).mass_kg, rel=0.01)
    assert found.value == pytest.approx(100.0 * (wrong - 1.0), abs=1.3)
    assert found.verdict == ("inside" if wrong == 1.0 else "outside")
    assert ("--mass auto" in found.hint) == (wrong != 1.0)


def test_the_law_of_impulse_holds_over_less_than_a_cycle():
    """Acceleration does not average out then, and is counted."""
    given, frame = evidence(), np.arange(len(evidence().times_s))
    parts = [given.restricted(given.accounted & (frame >= k) & (frame < k + 65)) for k in range(10, 200, 15)]
    found = [mass_finding(part, nothing(given)).better for part in parts]
    judged = [mass_kg for mass_kg in found if mass_kg is not None]
    assert len(judged) > 5
    assert judged == pytest.approx([body().mass_kg] * len(judged), rel=0.02)


def test_plates_that_contradict_each_other_accuse_nobody():
    read = plates()
    given = evidence(read=amplified(read, [0.9] * len(read)))
    assert mass_finding(given, nothing(given)).verdict == "outside"
    found = mass_finding(given, nothing(given), plates_agree=False)
    assert found.verdict == "doubtful" and found.better is None


def test_who_sits_is_weighed_only_while_standing():
    given = evidence("squat")
    sits = np.zeros(len(given.times_s), dtype=bool)
    sits[: len(sits) // 2] = True
    raw = given.raw.copy()
    raw[sits] *= 0.4
    seated = replace(given, raw=raw)
    assert mass_finding(seated, nothing(given)).verdict == "not judged"
    assert mass_finding(seated, sits).better == pytest.approx(body("squat").mass_kg, rel=0.02)


def hops_from_a_box(mass_kg, hops, rate_hz=200.0):
    """One second on a box without a plate, then falls of 0.3 s and contacts of 0.2 s on a plate."""
    fall, contact = 60, 40
    on_plate = np.concatenate([np.zeros(200), np.tile(np.repeat([0.0, 1.0], [fall, contact]), hops)])
    standing = np.arange(len(on_plate)) < 200
    push = GRAVITY_M_S2 * (fall + contact) / contact
    per_kg = np.where(standing, GRAVITY_M_S2, push * on_plate)
    rise = per_kg - GRAVITY_M_S2
    speed = np.concatenate([[0.0], np.cumsum(0.5 * (rise[1:] + rise[:-1]))]) / rate_hz
    accounted = np.ones(len(on_plate), dtype=bool)
    return VerticalLoads(rate_hz, 70.0, mass_kg * push * on_plate, speed, accounted)


def test_who_stands_on_a_box_is_weighed_from_the_landing_on():
    """The flights between contacts count; without them the contacts are too short."""
    loads = hops_from_a_box(37.0, hops=4)
    found = impulse_finding(loads, np.zeros(len(loads.force_n), dtype=bool))
    assert found.better == pytest.approx(37.0, rel=0.01)
    assert found.verdict == "outside"


def test_too_little_is_not_judged():
    given = evidence()
    short = given.restricted(np.arange(len(given.times_s)) < 40)
    assert mass_finding(short, nothing(given)).verdict == "not judged"


@pytest.mark.parametrize("breaks", [1, 2, 4])
def test_each_stretch_adds_the_errors_of_two_speeds(breaks):
    """Where one part begins with the frame that ends another the speed between them cancels."""
    given, frame = evidence("squat"), np.arange(len(evidence("squat").times_s))
    gaps = np.linspace(0, len(frame), breaks + 1)[1:-1].astype(int)
    kept = given.accounted & ~np.isin(frame, gaps)
    seconds = (kept.sum() - breaks) / given.rate_hz
    speeds_percent = 100.0 * SPEED_SD_M_S * np.sqrt(2.0 * breaks) / (GRAVITY_M_S2 * seconds)
    sd = mass_finding(given.restricted(kept), nothing(given)).expected_sd
    assert sd**2 - SCALE_PERCENT**2 == pytest.approx(speeds_percent**2, rel=0.1)
