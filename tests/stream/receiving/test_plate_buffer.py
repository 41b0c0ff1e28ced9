"""Means over frames are those of a whole trial, bit for bit, and what was not read is NaN."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.conventions import GRAVITY_M_S2
from mbkf.io.records import PlateReadings
from mbkf.io.resample import WHOLE
from mbkf.sensors.contact.cleaning import cleaned, longest_bridge
from mbkf.sensors.contact.plates import plate_wrenches
from mbkf.stream.receiving.plate_buffer import PlateBuffer
from mbkf.stream.source import PlateSamples, StreamDescription, without_readings

RATE_HZ = 100.0


def plates_of(rate_hz, samples, start_s=0.0, seed=0):
    rng = np.random.default_rng(seed)
    return tuple(
        PlateReadings(
            str(k),
            rate_hz,
            start_s,
            rng.normal(size=3),
            rng.normal(0.0, 300.0, (samples, 3)),
            rng.normal(0.0, 50.0, (samples, 3)),
            np.full((samples, 3), np.nan),
            20.0,
        )
        for k in range(2)
    )


def buffer_of(plates, start_s=0.0):
    described = tuple(without_readings(plate) for plate in plates)
    return PlateBuffer(StreamDescription("x", ("A",), RATE_HZ, start_s, described))


def readings(plates):
    return np.stack([np.hstack([p.force_n, p.moment_nm]) for p in plates], axis=1)


@settings(deadline=None, max_examples=30)
@given(
    rate_hz=st.sampled_from([100.0, 300.0, 1000.0, 1234.5]),
    frames_from_s=st.sampled_from([0.0, 1.25, -0.5]),
    plates_after_s=st.sampled_from([0.0, 0.003, -0.2]),
    chunk=st.integers(1, 40),
)
def test_means_are_those_of_the_whole_trial(rate_hz, frames_from_s, plates_after_s, chunk):
    plates = plates_of(rate_hz, int(0.6 * rate_hz), frames_from_s + plates_after_s)
    values = readings(plates)
    expected = plate_wrenches(plates, frames_from_s + np.arange(40) / RATE_HZ, RATE_HZ)
    buffer, sent = buffer_of(plates, frames_from_s), 0
    for number in range(40):
        needed = ((number + 0.5) / RATE_HZ - plates_after_s) * rate_hz
        while sent - 1 < needed - WHOLE and sent < len(values):
            index = np.arange(sent, min(sent + chunk, len(values)))
            buffer.put(PlateSamples(index, values[index]))
            sent = index[-1] + 1
        np.testing.assert_array_equal(buffer.mean(number), expected[number])


@pytest.mark.usefixtures("either_kernel")
@pytest.mark.parametrize("rate_hz", [100.0, 1234.5])
def test_means_are_a_whole_trial_s_by_either_kernel(rate_hz):
    """Round the ring, and with a plate that was not read for a while."""
    plates = plates_of(rate_hz, int(3.0 * rate_hz))
    values, index = readings(plates), np.arange(int(3.0 * rate_hz))
    values[len(values) // 2 : len(values) // 2 + 50, 1] = np.nan
    known = [
        replace(plate, force_n=values[:, k, :3], moment_nm=values[:, k, 3:]) for k, plate in enumerate(plates)
    ]
    expected = plate_wrenches(known, np.arange(299) / RATE_HZ, RATE_HZ)
    assert np.isnan(expected).any()
    buffer = buffer_of(plates)
    for number in range(299):
        sent = 0 if buffer.newest is None else buffer.newest + 1
        until = min(int((number + 0.5) / RATE_HZ * rate_hz) + 2, len(values))
        buffer.put(PlateSamples(index[sent:until], values[sent:until]))
        np.testing.assert_array_equal(buffer.mean(number), expected[number])


@pytest.mark.parametrize("number", [403, 1612, 1617])
def test_a_sample_past_the_end_of_a_frame_changes_nothing(number):
    """These frames' ends lie a rounding error behind a sample."""
    assert number / RATE_HZ * 1000.0 + 5.0 > 10 * number + 5
    plates = plates_of(1000.0, 10 * number + 20)
    values, index = readings(plates), np.arange(10 * number - 20, 10 * number + 20)
    (expected,) = plate_wrenches(plates, np.array([number / RATE_HZ]), RATE_HZ)
    for last in (6, 7, 12):
        buffer, known = buffer_of(plates), index[: 20 + last]
        buffer.put(PlateSamples(known, values[known]))
        np.testing.assert_array_equal(buffer.mean(number), expected)


def test_before_the_first_sample_and_far_from_any_nothing_is_read():
    plates = plates_of(1000.0, 200)
    buffer = buffer_of(plates)
    assert np.isnan(buffer.mean(0)).all()
    buffer.put(PlateSamples(np.arange(100), readings(plates)[:100]))
    assert np.isfinite(buffer.mean(5)).all()
    assert np.isnan(buffer.mean(30)).all()


def without(lost, plates, parts):
    """A buffer that never received some samples, in so many parts."""
    index, buffer = np.delete(np.arange(300), lost), buffer_of(plates)
    for part in np.array_split(index, parts):
        buffer.put(PlateSamples(part, readings(plates)[part]))
    return buffer


@pytest.mark.parametrize("parts", [1, 30])
def test_lost_samples_leave_their_frames_unread(parts):
    lost = np.arange(95, 124)
    assert len(lost) > longest_bridge(1000.0)
    buffer = without(lost, plates_of(1000.0, 300), parts)
    unread = [np.isnan(buffer.mean(number)).any() for number in range(29)]
    assert np.flatnonzero(unread).tolist() == [9, 10, 11, 12]
    assert buffer.missing == 29


@pytest.mark.parametrize("parts", [1, 30])
def test_few_lost_samples_are_bridged_as_in_a_whole_trial(parts):
    plates, lost = plates_of(1000.0, 300), np.arange(95, 119)
    whole = tuple(
        replace(plate, force_n=gapped(plate.force_n, lost), moment_nm=gapped(plate.moment_nm, lost))
        for plate in plates
    )
    clean, remarks = cleaned(whole, 10_000.0)
    assert len(remarks) == len(plates)
    expected = plate_wrenches(clean, np.arange(29) / RATE_HZ, RATE_HZ)
    buffer = without(lost, plates, parts)
    np.testing.assert_array_equal([buffer.mean(number) for number in range(29)], expected)


def gapped(values, lost):
    found = np.array(values)
    found[lost] = np.nan
    return found


def loaded_plates(samples, mass_kg):
    """A person rocking from foot to foot on two plates; both plates possible for the mass, with noise."""
    weight, t = GRAVITY_M_S2 * mass_kg, np.arange(samples) / 1000.0
    rng, made = np.random.default_rng(3), []
    for k, plate in enumerate(plates_of(1000.0, samples)):
        share = 0.5 + 0.3 * np.sin(8.0 * t + np.pi * k)
        force = weight * np.stack([0.05 * share, 0.03 * share, share], axis=1) + rng.normal(size=(samples, 3))
        moment = weight * 0.05 * np.stack([share, -share, 0.1 * share], axis=1) + rng.normal(
            size=(samples, 3)
        )
        made.append(replace(plate, force_n=force, moment_nm=moment))
    return tuple(made)


@settings(deadline=None, max_examples=40)
@given(
    at=st.integers(30, 250),
    length=st.integers(1, 40),
    channel=st.integers(0, 5),
    value=st.sampled_from([1e5, -1e5, 1e9, np.nan, np.inf, -np.inf]),
    plate=st.integers(0, 1),
    chunk=st.integers(1, 15),
)
def test_what_is_refused_by_value_is_refused_as_offline(at, length, channel, value, plate, chunk):
    """Frames agree with the whole trial's, but for those due before a gap ended, which stay unread."""
    mass_kg, plates = 70.0, loaded_plates(300, 70.0)
    values = np.array(readings(plates))
    values[at : at + length, plate, channel] = value
    broken = tuple(
        replace(one, force_n=values[:, k, :3], moment_nm=values[:, k, 3:]) for k, one in enumerate(plates)
    )
    expected = plate_wrenches(cleaned(broken, mass_kg)[0], np.arange(29) / RATE_HZ, RATE_HZ)
    described = tuple(without_readings(one) for one in plates)
    buffer = PlateBuffer(StreamDescription("x", ("A",), RATE_HZ, 0.0, described), mass_kg)
    sent = 0
    for number in range(29):
        while sent - 1 < 10 * (number + 0.5):
            index = np.arange(sent, min(sent + chunk, 300))
            taken = buffer.put(PlateSamples(index, values[index]))
            assert np.isfinite(taken.wrench).all(axis=2).sum() == (
                2 * len(index) - ((index >= at) & (index < at + length)).sum()
            )
            sent = index[-1] + 1
        found = buffer.mean(number)
        open_gap = at <= 10 * (number + 0.5) and at + length >= sent
        if open_gap:
            assert np.isnan(found[plate]).all()
            np.testing.assert_array_equal(found[1 - plate], expected[number, 1 - plate])
        else:
            np.testing.assert_array_equal(found, expected[number])
    assert buffer.refused == length


def test_old_samples_are_not_taken_again():
    plates = plates_of(1000.0, 300)
    buffer, values = buffer_of(plates), readings(plates)
    buffer.put(PlateSamples(np.arange(100), values[:100]))
    assert not len(buffer.put(PlateSamples(np.arange(50, 90), 0.0 * values[50:90])).index)
    fresh = buffer.put(PlateSamples(np.arange(90, 120), values[90:120]))
    assert fresh.index.tolist() == list(range(100, 120))
    expected = plate_wrenches(plates, np.arange(10) / RATE_HZ, RATE_HZ)
    np.testing.assert_array_equal([buffer.mean(n) for n in range(10)], expected)


def test_readings_go_on_where_the_oldest_are_overwritten():
    plates, chunk = plates_of(1000.0, 2070), 9
    buffer, values = buffer_of(plates), readings(plates)
    assert len(buffer._values) == 225 * chunk - 1  # one chunk is a sample too long for the room at the end
    for begin in range(0, 2070, chunk):
        samples = np.arange(begin, begin + chunk)
        buffer.put(PlateSamples(samples, values[samples]))
    expected = plate_wrenches(plates, np.arange(200, 206) / RATE_HZ, RATE_HZ)
    np.testing.assert_array_equal([buffer.mean(n) for n in range(200, 206)], expected)


def test_after_a_long_silence_what_was_before_is_forgotten():
    plates = plates_of(1000.0, 100)
    buffer, values = buffer_of(plates), readings(plates)
    buffer.put(PlateSamples(np.arange(100), values))
    buffer.put(PlateSamples(np.arange(100) + 50_000, values))
    assert np.isnan(buffer.mean(5)).all()
    assert np.isfinite(buffer.mean(5005)).all()


def test_without_plates_there_is_nothing_to_read():
    buffer = PlateBuffer(StreamDescription("x", ("A",), RATE_HZ))
    assert buffer.mean(0).shape == (0, 6)
    assert not len(buffer.put(PlateSamples.none(0)).index)


def test_a_sample_that_came_already_is_not_taken_again():
    buffer = buffer_of(plates_of(100.0, 1))
    wrench = np.arange(36.0).reshape(3, 2, 6)
    buffer.put(PlateSamples(np.arange(3), wrench))
    again = buffer.put(PlateSamples(np.arange(2, 5), wrench))
    np.testing.assert_array_equal(again.index, [3, 4])
    np.testing.assert_array_equal(again.wrench, wrench[1:])
    assert (buffer.newest, buffer.missing) == (4, 0)
