"""What the instruments record: noise of the stated size, occlusions, ghosts, plates; and the files read back."""

import numpy as np
import pytest
from scipy.signal import welch
from scipy.stats import chi2

from mbkf.errors import InvalidInput, NotConverged
from mbkf.io.c3d import read_c3d
from mbkf.io.c3d_write import write_c3d
from mbkf.io.capture_options import CaptureOptions
from mbkf.numerics.runs import runs
from mbkf.synthesis import cameras
from mbkf.synthesis.capture import CaptureSettings, synthesise_capture
from mbkf.synthesis.person import LIMIT, STATURE_RANGE, body_of, synthesise_subject

pytestmark = pytest.mark.slow


def test_camera_noise_has_the_stated_size(person, motions):
    clean = CaptureSettings(skin_sd_m=0.0, occlusion=0.0)
    made = synthesise_capture(person, motions["squat"], clean, seed=1)
    error = made.trial.markers.positions_m - made.truth.markers_m
    low, high = chi2.interval(0.999, error.size)
    assert low < (error**2).sum() / clean.markers_sd_m**2 < high


def test_skin_artefact_is_slow_and_has_the_stated_size():
    moved = cameras.skin_artefact((4000, 300), 100.0, 0.003, 0.8, np.random.default_rng(0))
    assert moved.std() == pytest.approx(0.003, rel=0.03)
    frequency, power = welch(moved, fs=100.0, nperseg=2000, axis=0)
    power = power.mean(axis=1)
    assert power[frequency > 3].sum() < 0.02 * power.sum()
    half = np.interp(0.8, frequency, power) / power[1:4].mean()
    assert half == pytest.approx(0.5, abs=0.1)


def test_occlusions_reach_the_fraction_in_streaks():
    hidden = cameras.occlusions(2000, 36, 0.1, np.random.default_rng(0))
    assert hidden.mean() == pytest.approx(0.1, abs=0.001)
    lengths = [end - start for column in hidden.T for start, end in runs(column) if start > 0 and end < 2000]
    assert min(lengths) >= cameras.OCCLUSION_FRAMES
    assert cameras.occlusions(40, 3, 1.0, np.random.default_rng(0)).all()


@pytest.mark.parametrize("fraction", [-0.1, 1.01, float("nan")])
def test_a_fraction_that_is_no_part_is_refused(fraction):
    with pytest.raises(InvalidInput, match="hidden fraction must be between 0 and 1"):
        cameras.occlusions(20, 3, fraction, np.random.default_rng(0))


def test_streaks_that_hide_the_same_samples_end():
    class Stuck:
        def integers(self, *_bounds):
            return 0

    with pytest.raises(NotConverged, match="20 of 60 samples are hidden"):
        cameras.occlusions(20, 3, 1.0, Stuck())


def test_raw_points_are_the_trial_s_in_another_order_with_ghosts(capture):
    labelled, raw = capture.trial.markers.positions_m, capture.raw.markers.positions_m
    assert all(name.startswith("*") for name in capture.raw.markers.names)
    extra = raw.shape[1] - labelled.shape[1]
    assert extra == 2
    for known, points in zip(labelled[::20], raw[::20], strict=True):
        seen = known[~np.isnan(known).any(axis=1)]
        there = points[~np.isnan(points).any(axis=1)]
        nearest = np.abs(there[:, None] - seen[None]).max(axis=2).min(axis=0)
        assert (nearest == 0).all()
        assert 0 <= len(there) - len(seen) <= extra
    assert not np.array_equal(raw[10, :30], labelled[10, :30])


@pytest.mark.parametrize("name", ["walk", "turn", "step_up"])
def test_plates_read_the_feet_s_wrenches(person, motions, name):
    exact = CaptureSettings(force_sd_n=0.0, moment_sd_nm=0.0, offset_n=(0.0, 0.0))
    made = synthesise_capture(person, motions[name], exact, seed=2)
    force = sum(plate.force_n for plate in made.trial.plates)
    moment = sum(plate.moment_nm + np.cross(plate.origin_m, plate.force_n) for plate in made.trial.plates)
    assert len(made.trial.plates) >= 4
    assert np.abs(np.hstack([force, moment]) - motions[name].plate_wrench.sum(axis=1)).max() < 1e-9
    for plate in made.trial.plates:
        pressed = plate.centre_of_pressure_m[~np.isnan(plate.centre_of_pressure_m[:, 0])]
        low, high = plate.corners_m.min(axis=0), plate.corners_m.max(axis=0)
        assert ((pressed[:, :2] > low[:2]) & (pressed[:, :2] < high[:2])).all()


def test_plates_do_not_overlap(capture, person, motions):
    moved = [synthesise_capture(person, motions[name], seed=2) for name in ("walk", "turn", "general")]
    for recorded in (capture.trial.plates, capture.static.plates, *(made.trial.plates for made in moved)):
        corners = [(p.corners_m.min(axis=0)[:2], p.corners_m.max(axis=0)[:2]) for p in recorded]
        for k, (low, high) in enumerate(corners):
            for other_low, other_high in corners[:k]:
                assert (high <= other_low).any() or (other_high <= low).any()


def test_unloaded_plates_show_their_offset(capture, motions):
    off, down = motions["jump"].flight_s
    for plate in capture.trial.plates:
        air = (plate.times_s > off + 0.01) & (plate.times_s < down - 0.01)
        assert -26 < plate.force_n[air, 2].mean() < -9


def test_events_are_where_contact_begins_and_ends(capture, motions):
    off, down = motions["jump"].flight_s
    assert sorted({(e.label, e.context) for e in capture.trial.events}) == [
        ("Foot Off", "Left"),
        ("Foot Off", "Right"),
        ("Foot Strike", "Left"),
        ("Foot Strike", "Right"),
    ]
    for event in capture.trial.events:
        assert event.time_s == pytest.approx(off if event.label == "Foot Off" else down, abs=0.002)


def test_static_is_a_full_quiet_standing(capture):
    static = capture.static
    assert static.markers.present.all()
    assert 1.0 <= static.markers.frames / static.markers.rate_hz <= 2.0
    assert np.ptp(static.markers.positions_m, axis=0).max() < 0.02
    total = sum(plate.force_n[:, 2] for plate in static.plates).mean()
    assert total == pytest.approx(capture.static.subject_mass_kg * 9.80665, rel=0.01)


def test_c3d_round_trip(capture, tmp_path):
    write_c3d(capture.trial, tmp_path / "trial.c3d")
    back = read_c3d(tmp_path / "trial.c3d", CaptureOptions())
    assert np.nanmax(np.abs(back.markers.positions_m - capture.trial.markers.positions_m)) < 1e-6
    assert np.array_equal(back.markers.present, capture.trial.markers.present)
    assert len(back.plates) == len(capture.trial.plates)
    assert back.subject_mass_kg == pytest.approx(capture.trial.subject_mass_kg, rel=1e-6)
    assert len(back.events) == len(capture.trial.events)
    every = round(back.plates[0].rate_hz / back.markers.rate_hz)
    true = capture.truth.foot_wrench[:, :, 2].sum(axis=1)
    read = sum(plate.force_n[::every, 2] for plate in back.plates)
    assert np.abs(read - true[: len(read)]).max() < 12.0


def test_seeds_repeat_and_differ(person, motions):
    first, again, other = (
        synthesise_capture(person, motions["squat"], seed=s).trial.markers.positions_m for s in (1, 1, 2)
    )
    assert np.array_equal(first, again, equal_nan=True)
    assert not np.array_equal(first, other, equal_nan=True)


def test_height_and_mass_can_be_given():
    tall, small = (
        synthesise_subject(3, height_m=height, mass_kg=mass) for height, mass in ((1.86, 85.0), (1.55, 49.75))
    )
    assert (tall.height_m, tall.mass_kg) == (pytest.approx(1.86), 85.0)
    assert body_of(small).mass_kg == pytest.approx(49.75)
    for name, factor in tall.scale_factors.items():
        assert small.scale_factors[name] / factor == pytest.approx(1.55 / 1.86)
    with pytest.raises(InvalidInput, match="mass_kg"):
        synthesise_subject(mass_kg=-1.0)


def test_people_differ_plausibly():
    people = [synthesise_subject(seed) for seed in range(20)]
    assert len({p.mass_kg for p in people}) == 20
    for p in people:
        common = p.height_m / 1.80
        assert STATURE_RANGE[0] <= common <= STATURE_RANGE[1]
        assert all(abs(f / common - 1) <= LIMIT + 1e-12 for f in p.scale_factors.values())
        assert 20 < p.mass_kg / p.height_m**2 < 28


@pytest.mark.parametrize(
    "wrong",
    [
        {"markers_sd_m": -1.0},
        {"occlusion": 2.0},
        {"skin_sd_m": float("nan")},
        {"ghosts": -1},
        {"skin_cutoff_hz": 0.0},
    ],
)
def test_wrong_settings_are_refused(wrong):
    with pytest.raises(InvalidInput):
        CaptureSettings(**wrong)
