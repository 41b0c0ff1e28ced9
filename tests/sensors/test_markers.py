"""Markers as a block: what it notes for others, what a displaced limb does, and how its noise follows innovations.

The noise over time and the gate are tested with the whole filter and in test_gating.py.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from mbkf.sensors.markers import DISPLACED_SD_RAD, DISPLACED_SD_RAD_S, MarkerMemory, Markers, MarkerSettings
from tests.dynamics import DT, MARKER_SD_M, notes_of, prepared_at, standing
from tests.motions import assert_near, markers_only, protocol_sensor, reference_model

MODEL = reference_model()
NV = MODEL.nv
SENSOR = protocol_sensor(MODEL)[0]
NOISE = np.full(len(SENSOR.segments), MARKER_SD_M)
HAND = np.isin(SENSOR.segments, ["right_hand"])
STATE = SimpleNamespace(q=standing(MODEL), v=np.zeros(NV), a=np.zeros(NV), P=1e-6 * np.eye(2 * NV))


def block_with(**settings):
    return Markers(SENSOR, NOISE, DT, np.zeros(NV, dtype=bool), MarkerSettings(**settings))


def decided(block, markers_m, memory=None):
    """Its decision and notes."""
    at, notes = prepared_at(block, STATE), notes_of()
    return at, block.decide(at, markers_only(markers_m), memory or block.begin(), notes), notes


def test_markers_are_predicted_where_the_sensor_says():
    at, _, _ = decided(block_with(), SENSOR.positions(STATE.q))
    np.testing.assert_array_equal(at.prepared.positions_m, SENSOR.positions(STATE.q))


def test_what_is_seen_used_and_left_unobserved_is_noted():
    markers = SENSOR.positions(STATE.q)
    markers[HAND] = np.nan
    markers[3] += 0.8
    _, decision, notes = decided(block_with(), markers)
    np.testing.assert_array_equal(notes.seen, ~HAND)
    np.testing.assert_array_equal(notes.trusted, ~HAND & (np.arange(len(NOISE)) != 3))
    np.testing.assert_array_equal(notes.unmarked, np.arange(NV)[MODEL.joint("right_hand").v])
    np.testing.assert_array_equal(notes.unobserved, notes.unmarked)
    assert notes.observed and not notes.lost
    assert decision.trusted is notes.trusted


@pytest.mark.parametrize(("shift_m", "lost"), [(0.0, False), (0.5, True)])
def test_a_body_far_from_its_prediction_is_lost_where_that_is_asked_for(shift_m, lost):
    markers = SENSOR.positions(STATE.q) + shift_m
    _, _, notes = decided(block_with(), markers)
    assert notes.lost == lost
    careless = Markers(SENSOR, NOISE, DT, np.zeros(NV, dtype=bool), track_loss=False)
    assert not decided(careless, markers)[2].lost


@pytest.mark.parametrize("inflates", [True, False])
def test_a_limb_that_comes_back_elsewhere_is_less_well_known(inflates):
    markers = SENSOR.positions(STATE.q)
    arm = np.isin(SENSOR.segments, ["right_forearm"])
    if np.count_nonzero(arm) < 2:
        pytest.skip("the protocol has too few markers there")
    markers[arm] += 0.4
    block = Markers(SENSOR, NOISE, DT, np.zeros(NV, dtype=bool), inflate=inflates)
    _, decision, notes = decided(block, markers)
    assert notes.trusted.all()
    P = np.zeros((2 * NV, 2 * NV))
    block.inflate(P, decision)
    own = np.arange(NV)[MODEL.joint("right_forearm").v]
    expected = np.zeros(2 * NV)
    if inflates:
        expected[own], expected[NV + own] = DISPLACED_SD_RAD**2, DISPLACED_SD_RAD_S**2
    np.testing.assert_array_equal(P, np.diag(expected))


def test_channels_are_used_markers_and_not_those_of_a_limb_found_elsewhere():
    places, forearm = SENSOR.positions(STATE.q), np.isin(SENSOR.segments, ["right_forearm"])
    markers = places + 0.003
    markers[forearm] = places[forearm] + 0.4
    markers[HAND] = np.nan
    block = block_with()
    read = block.channels(decided(block, markers)[1])
    np.testing.assert_array_equal(read.readings, 3 * ~(HAND | forearm))
    np.testing.assert_allclose(read.mean_square[read.readings > 0], 0.003**2, rtol=1e-10)
    np.testing.assert_array_equal(read.mean_square[read.readings == 0], 0.0)
    np.testing.assert_allclose(
        block.expected_spread(), MARKER_SD_M * MarkerSettings().innovation_share ** 0.5, rtol=1e-14
    )


def test_the_noise_scale_divides_the_information():
    block, markers = block_with(), SENSOR.positions(STATE.q) + 0.003
    plain, wide = (
        block.linearise(at, decision)
        for at, decision, _ in (decided(block, markers, MarkerMemory(scale, None)) for scale in (1.0, 4.0))
    )
    np.testing.assert_allclose(4.0 * wide.matrix, plain.matrix, rtol=1e-12)
    np.testing.assert_allclose(4.0 * wide.vector, plain.vector, rtol=1e-12, atol=1e-9)
    assert wide.innovation == pytest.approx(plain.innovation / 4.0)
    difference = block.log_noise(decided(block, markers, MarkerMemory(4.0, None))[1]) - block.log_noise(
        decided(block, markers)[1]
    )
    assert difference == pytest.approx(3 * len(NOISE) * np.log(4.0))


def test_where_skin_is_modelled_the_markers_used_are_kept():
    block, markers = block_with(skin_memory_s=0.3), SENSOR.positions(STATE.q)
    markers[HAND] = np.nan
    at, decision, _ = decided(block, markers)
    kept = block.remember(STATE, at, decision, block.begin()).before_m
    np.testing.assert_array_equal(kept, markers)
    again = decided(block, SENSOR.positions(STATE.q), MarkerMemory(1.0, kept))
    assert len(block.linearise(again[0], again[1]).vector) == 3 * NV
    assert len(block.linearise(at, decision).vector) == NV


def test_a_settings_factor_widens_the_noise():
    assert_near(block_with(marker_noise_scale=3.0).noise_m, 3.0 * NOISE, 1e-15)


@pytest.mark.parametrize(("size", "expected"), [(1.0, 1.0), (3.0, 9.0), (0.1, 0.25), (50.0, 16.0)])
def test_noise_that_stays_follows_its_own_spread(size, expected):
    """One frame shows the spread of a reading, however wide the white noise of equal weight is."""
    spread = np.full(len(NOISE), 0.02)
    settings = MarkerSettings(noise_memory_s=1e-6)
    block = Markers(SENSOR, 4.0 * spread, DT, np.zeros(NV, dtype=bool), settings, spread_m=spread)
    at, decision, _ = decided(block, SENSOR.positions(STATE.q) + 0.02 * size)
    decision = decision._replace(trusted=np.ones(len(NOISE), dtype=bool))
    assert block.remember(STATE, at, decision, block.begin()).noise_scale == pytest.approx(expected)


@pytest.mark.parametrize(("camera_m", "skin_m"), [(0.0004, 0.0), (0.0004, 0.003), (0.002, 0.0)])
def test_what_lasts_is_what_innovations_show_beyond_the_cameras_noise(camera_m, skin_m):
    """Skin that holds still for the trial is no white noise; quiet cameras are less than c can say."""
    rng, block, places = np.random.default_rng(7), block_with(), SENSOR.positions(STATE.q)
    memory, skin = block.begin(), skin_m * rng.normal(size=places.shape)
    for _ in range(round(8.0 * MarkerSettings().noise_memory_s / DT)):
        at, decision, notes = decided(block, places + skin + camera_m * rng.normal(size=places.shape), memory)
        memory = block.remember(STATE, at, decision, memory)
    assert memory.white.sd == pytest.approx(camera_m, rel=0.1)
    expected = np.mean(skin**2) / MARKER_SD_M**2 / MarkerSettings().innovation_share
    told = notes.lasting * memory.noise_scale
    white = camera_m**2 / MARKER_SD_M**2 / MarkerSettings().innovation_share
    assert told == pytest.approx(expected, rel=0.005, abs=0.04 * white)


def test_what_lasts_is_taken_as_expected_where_the_noise_is_white():
    block = block_with(innovation_share=0.0)
    assert block.begin().white is None
    assert decided(block, SENSOR.positions(STATE.q) + 0.003)[2].lasting == 1.0
