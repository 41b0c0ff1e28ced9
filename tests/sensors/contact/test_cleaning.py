"""Cleaned plates: clean ones are the same object, faults change nothing elsewhere, and cleaning twice is once."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.conventions import GRAVITY_M_S2
from mbkf.io.records import PlateReadings
from mbkf.sensors.contact.cleaning import BRIDGED_S, bridgeable, cleaned, longest_bridge
from tests.sensors.contact.test_faults import RATE_HZ, SAMPLES, WEIGHT_N, stance
from tests.walker import walker

MASS_KG = WEIGHT_N / GRAVITY_M_S2
FAULTS = {
    "far too much": lambda w, at, n: w[at : at + n, 2].__iadd__(1e5),
    "no number": lambda w, at, n: w[at : at + n].fill(np.nan),
    "spike": lambda w, at, n: w[at : at + n, 0].__iadd__(2000.0),
    "pull": lambda w, at, n: w[at : at + n, 2].__isub__(2000.0),
    "zeros": lambda w, at, n: w[at : at + n].fill(0.0),
}


def plate(wrench=None, scale=1.0, corners=True):
    wrench = scale * (stance() if wrench is None else wrench)
    at = np.array([1.0, 2.0, 0.0])
    outline = at + np.array([[0.2, 0.15, 0.0], [0.2, -0.15, 0.0], [-0.2, -0.15, 0.0], [-0.2, 0.15, 0.0]])
    nowhere = np.full((len(wrench), 3), np.nan)
    force, moment = wrench[:, :3], wrench[:, 3:]
    return PlateReadings(
        "a", RATE_HZ, 0.5, at, force, moment, nowhere, 20.0 * scale, outline if corners else None
    )


def readings(one):
    return np.hstack([one.force_n, one.moment_nm])


def clean(one, mass_kg=MASS_KG):
    (found,), remarks = cleaned([one], mass_kg)
    return found, remarks


def test_clean_plates_come_back_as_they_are():
    plates = (plate(), plate(corners=False), *walker().trial.plates)
    found, remarks = cleaned(plates, walker().subject.mass_kg)
    assert all(one is other for one, other in zip(found, plates, strict=True))
    assert remarks == ()
    assert cleaned((), MASS_KG) == ((), ())


@settings(deadline=None, max_examples=60)
@given(
    kinds=st.lists(st.sampled_from(sorted(FAULTS)), min_size=1, max_size=3),
    data=st.data(),
)
def test_cleaning_twice_is_cleaning_once(kinds, data):
    wrench = stance()
    for kind in kinds:
        at, length = data.draw(st.integers(0, SAMPLES - 1)), data.draw(st.integers(1, 60))
        FAULTS[kind](wrench, at, length)
    once, _ = clean(plate(wrench))
    twice, _ = clean(once)
    np.testing.assert_array_equal(readings(twice), readings(once))


@settings(deadline=None, max_examples=60)
@given(
    kind=st.sampled_from(["far too much", "no number", "spike"]),
    at=st.integers(2, SAMPLES - 60),
    length=st.integers(1, 50),
)
def test_a_fault_changes_nothing_elsewhere(kind, at, length):
    if kind == "spike":
        length = min(length, longest_bridge(RATE_HZ))
    wrench = stance()
    FAULTS[kind](wrench, at, length)
    found, (remark,) = clean(plate(wrench))
    gap = np.zeros(SAMPLES, dtype=bool)
    gap[at : at + length] = True
    np.testing.assert_array_equal(readings(found)[~gap], stance()[~gap])
    if length <= longest_bridge(RATE_HZ):
        ends = stance()[[at - 1, at + length]]
        line = ends[0] + np.linspace(0.0, 1.0, length + 2)[1:-1, None] * (ends[1] - ends[0])
        np.testing.assert_allclose(readings(found)[gap], line, rtol=1e-9, atol=1e-9)
    else:
        assert np.isnan(readings(found)[gap]).all()
    assert f"{length} of {SAMPLES} samples" in remark
    assert f"{0.5 + at / RATE_HZ:.3f}" in remark
    assert "\n" not in remark


@settings(deadline=None, max_examples=30)
@given(
    kind=st.sampled_from(sorted(FAULTS)),
    at=st.integers(0, SAMPLES - 1),
    length=st.integers(1, 60),
    scale=st.sampled_from([0.5, 2.0, 4.0]),
)
def test_a_heavier_person_with_larger_forces_is_judged_the_same(kind, at, length, scale):
    wrench = stance()
    FAULTS[kind](wrench, at, length)
    one, told = clean(plate(wrench))
    other, told_too = clean(plate(wrench, scale), scale * MASS_KG)
    np.testing.assert_array_equal(readings(other), scale * readings(one))
    assert told == told_too


def test_pressure_follows_the_bridge_and_is_unknown_in_a_gap():
    wrench = stance()
    wrench[400:410, 2] = wrench[600:700, 2] = 1e6
    found, _ = clean(plate(wrench))
    expected = (
        found.origin_m[:2]
        + np.stack([-found.moment_nm[405, 1], found.moment_nm[405, 0]]) / found.force_n[405, 2]
    )
    np.testing.assert_allclose(found.centre_of_pressure_m[405, :2], expected, rtol=1e-12)
    assert np.isnan(found.centre_of_pressure_m[600:700]).all()


def test_gaps_at_an_end_or_too_long_are_not_bridged():
    bad = np.zeros(200, dtype=bool)
    longest = longest_bridge(RATE_HZ)
    assert longest == BRIDGED_S * RATE_HZ
    for first, length in ((0, 3), (20, longest), (80, longest + 1), (198, 2)):
        bad[first : first + length] = True
    assert np.flatnonzero(bridgeable(bad, RATE_HZ)).tolist() == list(range(20, 20 + longest))


@pytest.mark.parametrize("corners", [True, False])
def test_all_kinds_of_one_plate_are_told_in_one_line(corners):
    wrench = stance()
    wrench[300, 2], wrench[350], wrench[500:503, 1] = 1e9, np.nan, 3000.0
    (found, _), remarks = cleaned([plate(wrench, corners=corners), plate()], MASS_KG)
    assert len(remarks) == 1
    assert "plate 'a': 5 of 1200 samples" in remarks[0]
    assert all(
        words in remarks[0] for words in ("1 with a force", "1 missing", "3 ", "0.800 s", "5 are bridged")
    )
    assert np.isfinite(readings(found)).all()
