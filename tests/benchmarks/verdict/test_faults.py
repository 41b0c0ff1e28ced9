"""Faults of the benchmark of verdicts change what they name, and nothing else."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.dynamic.methods import tared
from benchmarks.verdict.faults import KINDS
from benchmarks.verdict.recorded import BEARS, LASTS_S, Recorded, cut, named
from mbkf.conventions import GRAVITY_M_S2
from mbkf.trial.synth import synthesise

OF_MARKERS = (
    "names within a leg",
    "names across sides",
    "legs exchanged",
    "names from a frame on",
    "marker slipped",
    "leg hidden",
    "noise and ghosts",
    "wrong axes",
    "wrong unit",
)
OF_STATICS = ("names in the static", "static of another set")
OF_PLATES = (
    "clock",
    "plates turned",
    "plates exchanged",
    "gain",
    "dead plate",
    "plates displaced",
    "step beside",
    "harness",
    "pull",
    "chair",
    "box",
)


@pytest.fixture(scope="module")
def recorded() -> Recorded:
    subject, made = synthesise("walk", seconds=2.5, seed=1)
    return cut(named(made.static, tared(made.trial), subject))


def spoilt(recorded, kind, seed=0):
    found, label = KINDS[kind](recorded, np.random.default_rng(seed))
    assert label
    return found


def moved(a, b):
    return not np.array_equal(a.markers.positions_m, b.markers.positions_m, equal_nan=True)


def test_a_trial_is_cut_where_plates_bear_the_person(recorded):
    times = recorded.capture.markers.times_s
    assert len(times) == round(LASTS_S * 100.0)
    read = sum(np.interp(times, one.times_s, one.force_n[:, 2]) for one in recorded.capture.plates)
    assert (read > BEARS * recorded.subject.mass_kg * GRAVITY_M_S2).mean() > 0.95


@pytest.mark.parametrize("kind", OF_MARKERS)
def test_a_fault_of_markers_leaves_plates_and_person(recorded, kind):
    found = spoilt(recorded, kind)
    assert found == replace(recorded, capture=found.capture)
    assert moved(found.capture, recorded.capture) and found.capture.plates is recorded.capture.plates
    assert found.capture.markers.names == recorded.capture.markers.names


@pytest.mark.parametrize("kind", OF_STATICS)
def test_a_fault_of_the_static_is_scaled_from(recorded, kind):
    found = spoilt(recorded, kind)
    assert found == replace(recorded, static=found.static, scale_again=True)
    assert moved(found.static, recorded.static)


@pytest.mark.parametrize("kind", OF_PLATES)
def test_a_fault_of_plates_leaves_markers_and_person(recorded, kind):
    found = spoilt(recorded, kind)
    assert found.capture.markers is recorded.capture.markers and found.subject is recorded.subject
    changed = [
        one.start_time_s != before.start_time_s
        or not np.array_equal(one.force_n, before.force_n)
        or not np.array_equal(one.origin_m, before.origin_m)
        for one, before in zip(found.capture.plates, recorded.capture.plates, strict=True)
    ]
    assert any(changed)


def test_exchanged_plates_keep_their_places(recorded):
    found = spoilt(recorded, "plates exchanged").capture.plates
    before = recorded.capture.plates
    (a, b) = [p for p, one in enumerate(found) if not np.array_equal(one.force_n, before[p].force_n)]
    np.testing.assert_array_equal(found[a].force_n, before[b].force_n)
    np.testing.assert_array_equal(found[b].moment_nm, before[a].moment_nm)
    np.testing.assert_array_equal(found[a].origin_m, before[a].origin_m)
    pressed = found[a].centre_of_pressure_m - found[a].origin_m
    np.testing.assert_allclose(pressed, before[b].centre_of_pressure_m - before[b].origin_m, atol=1e-12)


def test_another_rate_leaves_the_samples(recorded):
    found = spoilt(recorded, "wrong rate").capture
    assert found.markers.rate_hz in (50.0, 200.0) and not moved(found, recorded.capture)


def test_mass_limb_and_person(recorded):
    assert spoilt(recorded, "mass").subject.mass_kg != recorded.subject.mass_kg
    thrown = spoilt(recorded, "leg thrown").thrown
    assert thrown.limb in ("right_thigh", "left_thigh") and 0 < thrown.frame < 180
    other = spoilt(recorded, "another person").subject
    assert other.mass_kg != recorded.subject.mass_kg and other.scale_factors != recorded.subject.scale_factors
    tested = {*OF_MARKERS, *OF_STATICS, *OF_PLATES, "wrong rate", "mass", "leg thrown", "another person"}
    assert set(KINDS) == tested
