"""Somebody who stands still is told from somebody who moves, and is scaled as `scale` does from a static trial."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput, NotObservable
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.model.human import HumanModel
from mbkf.model.protocol import load_protocol
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.trial.live.scaling import (
    LEAST_SEEN,
    STILL_M,
    StillWatch,
    plates_mass_kg,
    scale_standing,
    watched_names,
)
from mbkf.trial.scale import scale
from tests.captures import MASS_KG, made_capture, made_markers

RATE_HZ = 20.0
PLACES = np.random.default_rng(1).uniform(-1.0, 1.0, (30, 3))


def watch(named=True):
    return StillWatch(RATE_HZ, len(PLACES), named)


def still(watch, frames, points=PLACES, noise_m=0.001):
    """The last stance after frames of noisy points."""
    rng = np.random.default_rng(2)
    for _ in range(frames):
        stance = watch.push(points + rng.normal(0.0, noise_m, points.shape))
    return stance


def test_a_second_of_standing_is_enough_and_less_is_not():
    one = watch()
    assert not still(one, 19).enough
    stance = still(one, 1)
    assert stance.enough
    assert (stance.frames, stance.seen) == (20, 30)
    one.restart()
    assert not still(one, 19).enough


@pytest.mark.parametrize("marker", [0, 17])
def test_one_marker_that_moves_begins_the_second_anew(marker):
    one = watch()
    still(one, 15)
    moved = PLACES.copy()
    moved[marker, 2] += 1.5 * STILL_M
    stance = one.push(moved)
    assert (stance.frames, stance.mover, stance.enough) == (1, marker, False)
    assert stance.moved_m == pytest.approx(1.5 * STILL_M, abs=0.005)
    assert not still(one, 18, moved).enough
    assert still(one, 1, moved).enough


def test_a_slow_drift_is_no_standing():
    one = watch()
    step = np.array([1.2 * STILL_M / one.wanted, 0.0, 0.0])
    assert not any(one.push(PLACES + k * step).enough for k in range(200))


def test_markers_may_be_hidden_for_a_while_but_not_all_the_time():
    one, rng = watch(), np.random.default_rng(0)
    for _ in range(20):
        shown = np.where(rng.uniform(size=(30, 1)) < 0.3, np.nan, PLACES)
        stance = one.push(shown)
    assert stance.enough
    one.restart()
    hidden = PLACES.copy()
    hidden[int(LEAST_SEEN * 30) - 1 :] = np.nan
    stance = still(one, 40, hidden)
    assert (stance.frames, stance.seen, stance.enough) == (40, 23, False)
    assert still(one, 1).enough


@pytest.mark.parametrize("named", [True, False])
def test_hardly_a_marker_is_nobody(named):
    one = watch(named)
    still(one, 15)
    gone = np.full_like(PLACES, np.nan)
    gone[:5] = PLACES[:5]
    assert one.push(gone).frames == 0
    assert one.push(PLACES).frames == 1


def test_points_without_names_stand_still_in_any_order_and_number():
    one, rng = watch(named=False), np.random.default_rng(0)
    for _ in range(20):
        ghosts = rng.uniform(-2.0, 2.0, (2, 3))
        stance = one.push(rng.permutation(np.concatenate([PLACES[: rng.integers(28, 31)], ghosts])))
    assert stance.enough
    arm = PLACES.copy()
    arm[:6] += [0.0, 0.0, 0.2]
    assert one.push(rng.permutation(arm)).frames == 1


@pytest.mark.parametrize("named", [True, False])
@pytest.mark.parametrize("speed_m_s", [0.0, 1.0])
def test_who_moves_is_told_from_who_stands(named, speed_m_s):
    """Arms and legs that swing on the spot are no standing either."""
    moving = made_markers(150, 0.3).positions_m + speed_m_s / 100.0 * np.arange(150)[:, None, None]
    one = StillWatch(100.0, 36, named)
    assert not any([one.push(frame).enough for frame in moving])
    standing = made_markers(150, 0.0, noise_m=0.003).positions_m
    assert [one.push(frame).enough for frame in standing].index(True) == 99


def test_only_markers_of_the_protocol_are_looked_at():
    names = (*made_markers(2).names, "wand1", "wand2")
    assert watched_names(names, None) == names[:-2]
    assert watched_names(names, load_protocol("reference36")) == names[:-2]
    assert watched_names(("A", "B"), None) == ("A", "B")


def test_the_subject_is_the_one_of_scale():
    capture = made_capture(30, 0.0)
    found, expected = scale_standing(capture, mass_kg=70.0), scale(capture, mass_kg=70.0)
    assert (found.scale_factors, found.mass_kg) == (expected.scale_factors, 70.0)
    for one, other in zip(found.markers, expected.markers, strict=True):
        np.testing.assert_array_equal(one.position_m, other.position_m)


def test_plates_tell_the_mass_of_who_stands_on_them():
    capture = made_capture(30, 0.0)
    assert plates_mass_kg(capture.plates) == pytest.approx(MASS_KG)
    assert scale_standing(capture).mass_kg == pytest.approx(MASS_KG)


def test_an_idle_plate_that_is_a_little_off_and_one_that_is_dead_do_not_count():
    first, second = made_capture(30).plates
    off = replace(first, force_n=np.tile([0.0, 0.0, -12.0], (300, 1)))
    little = replace(first, force_n=np.tile([0.0, 0.0, 12.0], (300, 1)))
    dead = replace(first, force_n=np.full((300, 3), np.nan))
    assert plates_mass_kg((first, second, off, little, dead)) == pytest.approx(MASS_KG)


def test_nobody_on_the_plates_is_told():
    empty = [replace(plate, force_n=0.0 * plate.force_n) for plate in made_capture(30).plates]
    with pytest.raises(NotObservable, match=r"carry 0.0 kg; stand on them .* --mass KG"):
        plates_mass_kg(empty)


@pytest.mark.parametrize(("kept", "side"), [(0, "left"), (1, "right")])
def test_a_foot_beside_the_plates_makes_the_weight_no_mass(kept, side):
    capture = made_capture(30, 0.0)
    alone = replace(capture, plates=(capture.plates[kept],))
    with pytest.raises(NotObservable, match=f"the {side} foot is on no plate"):
        scale_standing(alone)
    assert scale_standing(alone, mass_kg=60.0).mass_kg == 60.0


def seated(bend_rad):
    """The reference person with hips and knees bent."""
    model = HumanModel.scaled(mass_kg=MASS_KG)
    worn = [marker for marker in load_protocol("reference36").markers if marker.kind != "computed"]
    sensor = MarkerSensor(model, [m.segment for m in worn], np.array([m.position_m for m in worn]))
    turn = np.zeros(model.nv)
    for side in ("right", "left"):
        turn[model.joint(f"{side}_thigh").v.start + 1] = -bend_rad
        turn[model.joint(f"{side}_shank").v.start + 1] = bend_rad
    frame = sensor.positions(model.integrate(model.neutral(), turn))
    markers = MarkerTrajectories(tuple(m.name for m in worn), np.tile(frame, (5, 1, 1)), 100.0)
    return Capture("", markers, ())


def test_who_sits_does_not_stand():
    with pytest.raises(NotObservable, match=r"does not stand \((hip|knee)_\w+ is (8|9)\d°\); stand upright"):
        scale_standing(seated(np.pi / 2), mass_kg=MASS_KG)
    crouched = seated(np.radians(40.0))
    assert scale_standing(crouched, mass_kg=MASS_KG).report["marker_rms_mm"] < 5.0


def test_points_without_names_need_a_protocol():
    points = MarkerTrajectories(("*0", "*1"), np.zeros((3, 2, 3)), 100.0)
    with pytest.raises(InvalidInput, match="--protocol"):
        scale_standing(Capture("", points, ()), mass_kg=70.0)
