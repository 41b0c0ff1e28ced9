"""Reactions and torques of a followed trial: known wrenches, what a person is told, and which frames count."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.io.contacts import Source
from mbkf.sensors.contact.plates import plate_wrenches
from mbkf.sensors.contact.records import Contact
from mbkf.synthesis.capture import CaptureSettings, synthesise_capture
from mbkf.trial.results.reactions import PRESSURE_FROM_N, ground_reactions
from tests.dynamics import trial
from tests.motions import assert_near, track_of

EXACT = CaptureSettings(0.0, 0.0, 0.8, 0.0, 0, 0.0, 0.0, (0.0, 0.0))
SOME = slice(20, 70)
FRAMES = SOME.stop - SOME.start
RATE_HZ = 100.0
RIGHT, LEFT = 0, 1
STANDING = [Contact.MEASURED, Contact.MEASURED]


def motion():
    return trial("squat").motion


@cache
def plates():
    """Two plates that read the truth, each with its own origin."""
    made = trial("squat")
    return synthesise_capture(made.subject, made.motion, EXACT).trial.plates


def followed(wrench=None, contact=None, **known):
    """A track of the true squat; the kinematic filter's unless it has wrenches (T, 2, 6)."""
    q, v, a = (getattr(motion(), name)[SOME] for name in ("q", "v", "a"))
    if wrench is not None:
        contact = np.tile(STANDING, (FRAMES, 1)) if contact is None else contact
        known |= {"wrench": wrench, "wrench_sd": np.ones((FRAMES, 2, 6)), "foot_contact": np.array(contact)}
    return track_of(q, v, a, **known)


def truly():
    """The feet's true wrenches, mean over a frame as plates give them."""
    return plate_wrenches(plates(), motion().times_s[SOME], RATE_HZ)


def found_with(track, plates=(), inputs=False):
    found = ground_reactions(trial("squat").model, track, motion().times_s[SOME], RATE_HZ, plates, inputs)
    parts = vars(found.loads) | vars(found.supports) | vars(found.torques)
    return SimpleNamespace(
        **parts, measured=found.measured, accounted=found.accounted, warnings=found.warnings
    )


@pytest.mark.slow
def test_measured_and_estimated_reactions_agree_where_the_estimate_is_exact():
    measured, estimated = found_with(followed(), plates()), found_with(followed(truly()), plates())
    assert_near(measured.foot_wrench, truly(), 1e-9)
    assert_near(estimated.tau, measured.tau, 1e-9)
    assert_near(estimated.foot_cop_m, measured.foot_cop_m, 1e-12)
    assert_near(estimated.foot_free_moment_nm, measured.foot_free_moment_nm, 1e-9)
    assert_near(estimated.residual_force_n, measured.residual_force_n, 1e-9)
    assert estimated.measured.all() and measured.measured.all()
    assert estimated.warnings == measured.warnings == ()


@pytest.mark.parametrize(
    ("inputs", "said"),
    [(False, "its reaction is estimated"), (True, "counts as 0, stands in the pelvis residual")],
)
def test_a_foot_without_a_plate_is_named_with_its_treatment(inputs, said):
    contact = np.tile([Contact.MEASURED, Contact.UNMEASURED], (FRAMES, 1))
    found = found_with(followed(truly(), contact), plates(), inputs)
    assert sum(said in one for one in found.warnings) == 1
    assert sum("a foot carries weight where no plate reads" in one for one in found.warnings) == 1


def test_torques_and_residuals_are_those_of_the_true_motion():
    """What is left is that plates average over a frame."""
    found = found_with(followed(truly()), plates())
    assert_near(found.tau, motion().tau[SOME], 3.0)
    assert_near(found.residual_force_n, 0.0, 3.0)
    assert_near(found.residual_moment_nm, 0.0, 3.0)


def test_residuals_are_the_measured_plates_whatever_was_estimated():
    wrong = found_with(followed(truly() + 50.0), plates())
    right = found_with(followed(truly()), plates())
    assert_near(wrong.residual_force_n, right.residual_force_n, 0.0)
    assert_near(wrong.residual_moment_nm, right.residual_moment_nm, 0.0)
    assert np.abs(wrong.tau - right.tau).max() > 10.0


def test_plates_are_unchanged_when_the_estimate_is_what_they_read():
    assert_near(found_with(followed(truly()), plates()).plate_change, 0.0, 1e-9)


def test_changes_are_about_the_plates_own_origins():
    """A force that changes by F at the world's origin changes the moment about o by −o × F."""
    added = np.array([3.0, -2.0, 7.0, 0.0, 0.0, 0.0])
    change = found_with(followed(truly() + added), plates()).plate_change
    for p, plate in enumerate(plates()):
        assert np.linalg.norm(plate.origin_m) > 0.05
        assert_near(change[:, p, :3] - added[:3], 0.0, 1e-9)
        assert_near(change[:, p, 3:] + np.cross(plate.origin_m, added[:3]), 0.0, 1e-9)


def test_a_foot_on_two_plates_is_compared_with_neither():
    """The plates' readings cannot be told apart in one wrench."""
    one = plates()[RIGHT]
    halves = [replace(one, name=n, force_n=0.5 * one.force_n, moment_nm=0.5 * one.moment_nm) for n in "ab"]
    change = found_with(followed(truly()), (*halves, plates()[LEFT])).plate_change
    assert np.isnan(change[:, :2]).all()
    assert_near(change[:, 2], 0.0, 1e-9)


def test_the_centre_of_pressure_of_a_known_wrench():
    point, force, free = np.array([0.3, -0.1, 0.0]), np.array([40.0, 30.0, 600.0]), 5.0
    wrench = np.zeros((FRAMES, 2, 6))
    wrench[:, RIGHT, :3] = force
    wrench[:, RIGHT, 3:] = np.cross(point, force)
    wrench[:, RIGHT, 5] += free
    wrench[:, LEFT, 2] = 0.9 * PRESSURE_FROM_N
    found = found_with(followed(wrench))
    assert_near(found.foot_cop_m[:, RIGHT], np.tile(point, (FRAMES, 1)), 1e-12)
    assert_near(found.foot_free_moment_nm[:, RIGHT], free, 1e-12)
    assert np.isnan(found.foot_cop_m[:, LEFT]).all()
    assert np.isnan(found.foot_free_moment_nm[:, LEFT]).all()


def test_without_plates_only_estimates_are_known():
    none = found_with(followed())
    for name in ("tau", "residual_force_n", "residual_moment_nm"):
        assert np.isnan(getattr(none, name)).all()
    assert none.warnings == ("no force plates: torques and residuals are not computed",)
    assert none.foot_wrench_sd is None and none.plate_change is None
    guessed = found_with(followed(truly()))
    assert np.isfinite(guessed.tau).all()
    assert np.isnan(guessed.residual_force_n).all()
    assert guessed.warnings == (
        "no force plates: reactions are estimated from the motion, residuals are not computed",
    )
    assert not none.measured.any() and not guessed.measured.any()


def feet(*changes):
    """Both feet on plates but for these (frames, foot, contact)."""
    contact = np.tile(STANDING, (FRAMES, 1))
    for frames, foot, what in changes:
        contact[frames, foot] = what
    return contact


@pytest.mark.parametrize(
    ("contact", "said", "unsaid"),
    [
        (feet(), "", "foot"),
        (feet((slice(5), LEFT, Contact.AIR)), "", "foot"),
        (
            feet((slice(7), LEFT, Contact.UNMEASURED)),
            "in 7 of 50 frames a foot carries weight where no plate",
            "both",
        ),
        (feet((slice(7), [0, 1], Contact.UNMEASURED)), "in 7 frames both feet do", "one plate"),
        (
            feet((slice(9), [0, 1], Contact.SHARED)),
            "in 9 frames both feet stand on one plate: their shares of its load are estimated from their places",
            "no plate",
        ),
    ],
)
def test_what_the_feet_do_is_told(contact, said, unsaid):
    words = " ".join(found_with(followed(truly(), contact), plates()).warnings)
    assert said in words
    assert unsaid not in words


def one_plate():
    """Both plates as one, outlined around both."""
    right, left = plates()
    corners = np.concatenate([right.corners_m, left.corners_m])
    low, high = corners.min(axis=0), corners.max(axis=0)
    outline = np.array([[high[0], low[1], 0.0], high, [low[0], high[1], 0.0], low])
    moment = right.moment_nm + left.moment_nm + np.cross(left.origin_m - right.origin_m, left.force_n)
    return (replace(right, force_n=right.force_n + left.force_n, moment_nm=moment, corners_m=outline),)


def test_one_plate_under_both_feet_is_shared_and_that_is_told():
    """Inverse dynamics gets the plate's whole wrench; the change of a plate is known of feet that stand alone."""
    found = found_with(followed(), one_plate())
    assert_near(found.foot_wrench.sum(axis=1), truly().sum(axis=1), 1e-9)
    assert_near(
        found.foot_wrench[:, :, 2], truly()[:, :, 2], 0.1 * trial("squat").model.mass_kg * GRAVITY_M_S2
    )
    assert (found.foot_wrench[:, :, 2] > 0.0).all() and found.measured.all()
    told = f"in {FRAMES} frames both feet stand on one plate: their shares of its load are estimated"
    assert any(warning.startswith(told) for warning in found.warnings)
    assert not any("one plate" in warning for warning in found_with(followed(), plates()).warnings)
    estimated = found_with(followed(truly(), feet((slice(None), [0, 1], Contact.SHARED))), one_plate())
    assert np.isnan(estimated.plate_change).all()


def test_frames_with_an_unread_loaded_foot_do_not_count():
    contact = feet((slice(10, 20), LEFT, Contact.UNMEASURED), (slice(30, 33), RIGHT, Contact.AIR))
    found = found_with(followed(truly(), contact), plates())
    np.testing.assert_array_equal(np.flatnonzero(~found.measured), np.arange(10, 20))


def test_frames_not_followed_stay_unknown():
    track = followed(truly())
    broken = replace(track, **{n: np.array(getattr(track, n)) for n in ("q", "v", "a", "wrench")})
    for name in ("q", "v", "a", "wrench"):
        getattr(broken, name)[3] = np.nan
    found = found_with(broken, plates())
    assert np.isnan(found.tau[3]).all() and np.isnan(found.residual_force_n[3]).all()
    assert np.isfinite(np.delete(found.tau, 3, axis=0)).all()
    assert np.isnan(found.plate_change[3]).all()


def with_load(part, force, frames=slice(20, 40)):
    """Loads on one part besides the feet, in some frames, and nothing on the others."""
    names = tuple(trial("squat").model.description.bearings)
    support = np.zeros((FRAMES, len(names), 6))
    support[frames, names.index(part), :3] = force
    return {"support": support, "support_sd": np.where(support != 0.0, 5.0, 0.0)}


def test_a_load_on_another_part_changes_the_torques_it_passes_through_and_the_residual_at_the_root():
    model = trial("squat").model
    load = with_load("pelvis", [0.0, 0.0, 100.0])
    alone, borne = found_with(followed(truly()), plates()), found_with(followed(truly(), **load), plates())
    change = borne.tau - alone.tau
    assert_near(change[:, 6:], 0.0, 1e-9)
    assert_near(np.linalg.norm(change[20:40, :3], axis=1), 100.0, 1e-9)
    assert_near(change[:20], 0.0, 0.0)
    assert_near(borne.residual_force_n, alone.residual_force_n, 0.0)
    hand = (
        found_with(followed(truly(), **with_load("right_hand", [50.0, 0.0, 0.0])), plates()).tau - alone.tau
    )
    assert np.abs(hand[25, model.joint("right_upper_arm").v]).max() > 1.0
    assert_near(hand[25, model.joint("left_upper_arm").v], 0.0, 1e-9)


def test_frames_in_which_another_part_bears_are_accounted_for_but_not_measured():
    found = found_with(followed(truly(), **with_load("pelvis", [0.0, 0.0, 100.0])), plates())
    np.testing.assert_array_equal(np.flatnonzero(~found.measured), np.arange(20, 40))
    assert found.accounted.all()


def test_a_foot_that_nothing_reads_is_accounted_for_where_the_filter_estimates_it():
    contact = feet((slice(10, 20), LEFT, Contact.UNMEASURED))
    found = found_with(followed(truly(), contact), plates())
    assert found.accounted.all() and not found.measured[10:20].any()
    assert (found.foot_source[10:20] == [Source.MEASURED, Source.ESTIMATED]).all()
    assert (found.foot_source[20:] == Source.MEASURED).all()
    none = found_with(followed())
    assert not none.accounted.any(), "plates that are not there explain nothing"


def test_where_nothing_bears_and_the_body_falls_no_plate_is_needed():
    contact = np.full((FRAMES, 2), Contact.AIR)
    contact[:10] = Contact.UNMEASURED
    track = followed(truly(), contact)
    falling = track.q.copy()
    falling[:, 2] -= 0.5 * GRAVITY_M_S2 * np.maximum(np.arange(FRAMES) - 10, 0) ** 2 / RATE_HZ**2
    assert not found_with(track).accounted[10:].any(), "the body does not fall"
    assert found_with(replace(track, q=falling)).accounted.all()
    seat = with_load("pelvis", [0.0, 0.0, 100.0], slice(20, 40))
    lying = found_with(replace(followed(truly(), contact, **seat), q=falling), plates())
    assert not lying.measured[20:40].any()


def test_what_is_no_foot_on_a_plate_is_not_accounted_for():
    """A third plate, out of reach of the feet, carries something."""
    stray = replace(plates()[RIGHT], origin_m=np.array([5.0, 5.0, 0.0]), corners_m=None)
    contact = feet((slice(10, 20), LEFT, Contact.UNMEASURED))
    found = found_with(followed(truly(), contact), (*plates(), stray))
    assert not found.accounted.any() and not found.measured.any()


def test_a_plate_that_both_feet_share_is_a_source_of_its_own():
    assert (found_with(followed(), one_plate()).foot_source == Source.SHARED).all()
    assert (found_with(followed(), plates()).foot_source == Source.MEASURED).all()
    assert (found_with(followed()).foot_source == Source.NONE).all()


@pytest.mark.parametrize(("in_air", "told"), [(0, False), (1, False), (5, True)])
def test_a_body_that_stands_on_nothing_and_does_not_fall_is_told(in_air, told):
    """A frame at take-off or landing is none to speak of."""
    contact = np.full((FRAMES, 2), Contact.UNMEASURED)
    contact[10 : 10 + in_air] = Contact.AIR
    warnings = found_with(followed(truly(), contact)).warnings
    assert any("does not fall" in warning for warning in warnings) == told
