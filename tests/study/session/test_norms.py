"""Norms: each person counts once, the spread is that between persons, and there are bands by speed and for the GDI."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput, UnknownName
from mbkf.io.norms import read_norms, write_norms
from mbkf.io.results_folder import write_reconstruction
from mbkf.io.session import SESSION_FILE, SessionNotes, write_session
from mbkf.study.session.cycles import Key
from mbkf.study.session.gather import session_of
from mbkf.study.session.norms import LEAST_AT_SPEED, LEAST_FOR_GDI, norms_of, person_sessions
from mbkf.study.session.scores import VARIABLES
from mbkf.trial.results.summary import summarise
from tests.study.session.emg import mixed
from tests.study.session.sessions import estimated, person, session, walks

KNEE = ("walk", "angle", "knee_angle")


def person_mean(one, key):
    return np.mean([side.curves[key].values.mean(axis=0) for side in one.gaits[0].sides], axis=0)


def many(count):
    """Persons whose curves lie apart by angles of their own."""
    rng = np.random.default_rng(3)
    one = person(1)
    (gait,) = one.gaits

    def moved(side):
        curves = {
            key: replace(c, values=c.values + rng.standard_normal() * np.hanning(101) + rng.standard_normal())
            for key, c in side.curves.items()
        }
        return replace(side, curves=curves)

    return [
        replace(one, name=f"P{k}", gaits=(replace(gait, sides=tuple(moved(side) for side in gait.sides)),))
        for k in range(count)
    ]


def test_mean_and_spread_between_persons():
    one, two = person(), person(count=1, first=6, age=40.0)
    norms = norms_of([one, two], "ours")
    means = [person_mean(each, Key("angle", "knee_angle")) for each in (one, two)]
    np.testing.assert_allclose(norms.curves[KNEE].mean, np.mean(means, axis=0))
    np.testing.assert_allclose(norms.curves[KNEE].sd, np.std(means, axis=0, ddof=1))
    assert norms.curves[KNEE].persons == 2 and norms.curves[KNEE].unit == "deg" and norms.name == "ours"
    speeds = [
        np.mean(
            np.concatenate(list(next(m for m in s.gaits[0].measures if m.name == "Speed").values.values()))
        )
        for s in (one, two)
    ]
    np.testing.assert_allclose(norms.measures[("walk", "Speed")].mean, [np.mean(speeds)])
    facts = norms.persons
    assert [(each.name, each.sex, each.age) for each in facts] == [
        ("session 5", "female", 30.0), ("session 6", "female", 40.0),
    ]  # fmt: skip
    np.testing.assert_allclose([each.speed_m_s for each in facts], speeds)
    assert [each.cycles for each in facts] == [
        sum(len(s.cycles) for s in e.gaits[0].sides) for e in (one, two)
    ]


def test_estimated_loads_and_muscles_do_not_count():
    plain = replace(session_of([estimated(r) for r in walks()], "x"), sex="male", age=20.0)
    norms = norms_of([plain, replace(plain, name="y")], "z")
    assert KNEE in norms.curves and ("walk", "torque", "knee_angle") not in norms.curves
    loud = replace(session_of(mixed(), "x"), sex="male", age=20.0)
    assert not any(key[1].startswith("emg") for key in norms_of([loud, replace(loud, name="y")], "z").curves)


def test_one_person_has_no_spread_and_the_others_are_named():
    with pytest.raises(
        InvalidInput, match=r"2 persons or more, here 1\. Left out: session 6: age and sex not stated"
    ):
        norms_of([person(), session(1, 6)], "x")


def test_the_person_in_view_is_never_among_them():
    three = [person(), person(1, 6), replace(person(1, 6), name="third")]
    assert [one.name for one in norms_of(three, "x", ["session 5"]).persons] == ["session 6", "third"]
    with pytest.raises(UnknownName, match="sesion 5"):
        norms_of(three, "x", ["sesion 5"])


def test_folders_of_a_batch_are_persons_with_the_facts_of_their_session_files(tmp_path):
    for name, first in (("P1", 5), ("P2", 6)):
        for r in walks(1, first):
            write_reconstruction(r, summarise(r), tmp_path / name / "walk")
    write_session(SessionNotes(sex="female", age=34.0), tmp_path / "P1" / SESSION_FILE)
    one, two = person_sessions([tmp_path])
    assert (one.name, one.sex, one.age, two.name, two.sex, two.age) == (
        "P1",
        "female",
        34.0,
        "P2",
        None,
        None,
    )


def test_bands_by_speed_where_there_are_enough(tmp_path):
    slow = [replace(person(1, 6), name=f"S{k}") for k in range(LEAST_AT_SPEED)]
    norms = norms_of([*slow, replace(_faster(person(1)), name="F")], "ours")
    ((low, high),) = norms.by_speed
    speed = norms.persons[0].speed_m_s
    assert low <= speed < high and high - low == pytest.approx(0.2)
    assert norms.by_speed[low, high][KNEE].persons == LEAST_AT_SPEED < norms.curves[KNEE].persons
    write_norms(norms, tmp_path / "n.toml")
    found = read_norms(tmp_path / "n.toml")
    assert found.persons == norms.persons and found.by_speed.keys() == norms.by_speed.keys()
    at = found.at_speed(speed)
    np.testing.assert_allclose(at.curves[KNEE].mean, norms.by_speed[low, high][KNEE].mean, rtol=1e-5)
    assert (
        "m/s" in at.name and found.at_speed(high).curves is found.curves and found.at_speed(np.nan) is found
    )


def _faster(one):
    (gait,) = one.gaits
    measures = tuple(
        replace(m, values={side: v + (1.0 if m.name == "Speed" else 0.0) for side, v in m.values.items()})
        for m in gait.measures
    )
    return replace(one, gaits=(replace(gait, measures=measures),))


def test_the_norms_own_persons_have_scores_and_an_index_of_100(tmp_path):
    """With as many persons as the index needs; one fewer has no index."""
    people = many(LEAST_FOR_GDI)
    assert norms_of(people[1:], "ours").gdi is None
    norms = norms_of(people, "ours")
    assert norms.gdi.features.shape == (15, 51 * 8) and norms.gdi.variables == VARIABLES[:8]
    write_norms(norms, tmp_path / "n.toml")
    found = read_norms(tmp_path / "n.toml").gdi
    np.testing.assert_allclose(found.features, norms.gdi.features, atol=1e-8)
    assert found.ln_mean == norms.gdi.ln_mean and found.variables == norms.gdi.variables
    assert (
        norms.measures["walk", "GPS"].mean[0] > 0.0
        and norms.measures["walk", "knee_angle"].persons == LEAST_FOR_GDI
    )
