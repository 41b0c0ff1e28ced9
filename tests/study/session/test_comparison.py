"""Two sessions compared: the difference of their means, with intervals that know whether the body is the same."""

from dataclasses import replace

import numpy as np

from mbkf.io.session import SessionNotes, TrialNotes
from mbkf.io.visit import Visit
from mbkf.study.session.comparison import (
    by_curve,
    compare,
    conditions_compared,
    is_same_body,
    measure_mean,
    measure_pairs,
    postures_apart,
)
from mbkf.study.session.cycles import Key
from mbkf.study.session.gather import session_of
from mbkf.study.session.means import difference_of
from tests.study.session.sessions import estimated, session, walks

KNEE = Key("angle", "knee_angle")


def moved(by_deg):
    return session_of([replace(r, angles=r.angles + np.deg2rad(by_deg)) for r in walks()], "moved")


def test_a_known_change_is_found():
    (found,) = compare(session(), moved(5.0))
    pairs = by_curve(found)
    for side in range(2):
        pair = pairs[(KNEE, side)]
        np.testing.assert_allclose(pair.difference.difference, 5.0, atol=1e-9)
        assert (pair.difference.low < 5.0).all() and (pair.difference.high > 5.0).all()
    np.testing.assert_allclose(pairs[(Key("angle", "pelvis_list"), 1)].difference.difference, -5.0, atol=1e-9)
    assert found.same_body


def test_shifts_count_for_another_body_alone():
    def shifted(results):
        return [replace(r, angles_sd_offset=0.015 * np.ones_like(r.angles)) for r in results]

    before, after = session_of(shifted(walks()), "a"), session_of(shifted(walks()), "b")
    other_body = replace(after, subject=replace(after.subject, scale_factors={"head": 1.0}))
    assert is_same_body(before.subject, after.subject)
    assert not is_same_body(before.subject, other_body.subject)
    same, other = (by_curve(compare(before, one)[0])[(KNEE, 0)].difference for one in (after, other_body))
    added = np.rad2deg(0.015) ** 2 * 2.0
    assert (other.half_width**2 > 1.96**2 * added).all()
    without = by_curve(compare(session(), session())[0])[(KNEE, 0)].difference
    np.testing.assert_allclose(same.half_width, without.half_width)


def test_the_shift_of_the_same_body_drops_out_in_the_same_posture_alone():
    """Of a knee that is bent more, by the share that this is of the postures' range."""

    def changing(results, by_rad):
        bent = [
            r.angles + by_rad * np.array([name == "knee_angle_r" for name in r.coordinate_names])
            for r in results
        ]
        return [
            replace(r, angles=angles, angles_sd_change=0.01 * np.ones_like(angles))
            for r, angles in zip(results, bent, strict=True)
        ]

    before = session_of(changing(walks(), 0.0), "a")
    still, moved = (session_of(changing(walks(), by), "b") for by in (0.0, 0.2))
    sides = [one.gaits[0].sides[0] for one in (before, still, moved)]
    assert not postures_apart(sides[0], sides[1]).any()
    means = [
        np.mean(curves.values, axis=0)
        for key, curves in sides[0].curves.items()
        if key.quantity == "angle" and curves.unit == "deg" and not key.name.startswith("pelvis")
    ]
    share = np.rad2deg(0.2) ** 2 / (2.0 * sum(mean.var() for mean in means))
    np.testing.assert_allclose(postures_apart(sides[0], sides[2]), share, rtol=1e-9)
    pair = by_curve(compare(before, moved)[0])[(KNEE, 0)]
    np.testing.assert_allclose(pair.after.mean.change_variance, np.rad2deg(0.01) ** 2, rtol=1e-5)
    expected = difference_of(pair.after.mean, pair.before.mean, True, share).half_width
    np.testing.assert_allclose(pair.difference.half_width, expected)
    assert not np.isclose(expected, difference_of(pair.after.mean, pair.before.mean, True).half_width).any()


def test_measured_loads_are_not_compared_with_estimated_ones():
    without = session_of([estimated(r) for r in walks()], "estimated")
    pairs = by_curve(compare(session(), without)[0])
    assert (KNEE, 0) in pairs and (Key("torque", "knee_angle"), 0) not in pairs
    both = by_curve(compare(without, without)[0])
    assert both[(Key("torque", "knee_angle"), 0)].before.estimated


def test_kinds_that_one_lacks_are_left_out():
    assert compare(replace(session(), gaits=()), session()) == ()


def test_measures_are_paired_by_side():
    measures = session().gaits[0].measures
    slower = tuple(replace(m, values={k: 0.9 * v for k, v in m.values.items()}) for m in measures)
    found = {(one.name, one.side): one for one in measure_pairs(measures, slower)}
    speed = found[("Speed", "r")]
    np.testing.assert_allclose(speed.difference.difference, -0.1 * speed.before.mean)
    assert set(found) == {(m.name, side) for m in measures for side in "rl"}
    unknown = replace(measures[0], values={"r": np.array([np.nan])}, trials={"r": ("a",)})
    assert measure_mean(unknown, "r") is None and measure_mean(unknown, "l") is None
    assert measure_pairs((unknown,), (unknown,)) == ()


def test_conditions_of_a_visit_are_compared_with_the_first():
    conditions = {"walk 0": "orthosis", "walk 1": "barefoot", "walk 2": "orthosis"}
    notes = SessionNotes(trials={name: TrialNotes(condition=one) for name, one in conditions.items()})
    whole = session_of(walks(3), "conditions", notes)
    assert [(one.condition, one.trials) for one in whole.gaits] == [
        ("barefoot", ("walk 1",)),
        ("orthosis", ("walk 0", "walk 2")),
    ]
    (found,) = conditions_compared(whole)
    assert found.conditions == ("barefoot", "orthosis") and found.same_body
    pair = by_curve(found)[(KNEE, 0)]
    np.testing.assert_allclose(pair.difference.difference, 0.0, atol=1e-9)
    alone = session_of(walks(3), "one", SessionNotes(visit=Visit(condition="barefoot")))
    assert conditions_compared(alone) == () and alone.gaits[0].condition == "barefoot"
    assert [one.conditions for one in compare(whole, alone)] == [("barefoot", "barefoot")]
    assert [one.conditions for one in compare(session(), alone)] == [("", "barefoot")]
    other = session_of(walks(2), "shoes", SessionNotes(visit=Visit(condition="shoes")))
    assert compare(whole, other) == (), "other conditions are no change"
