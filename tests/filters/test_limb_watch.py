"""A track whose limb is thrown into a wrong pose, or whose names are exchanged: set right soon, and stated."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from mbkf.filters.estimate import Recording
from mbkf.filters.fixed_lag import SmoothingSettings
from mbkf.filters.kinematic.filter import KinematicFilter
from mbkf.filters.kinematic.report import KinematicReport
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.kinematic.warm_start import WarmStart
from mbkf.filters.limb_watch import LimbWatch, in_doubt
from mbkf.filters.tracking import track
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.sensors.limb_fit import LimbEvidence, LimbFits
from mbkf.sensors.limb_starts import opposite_markers, turned_over
from tests.motions import marker_positions, protocol_sensor, reference_model, smooth_motion

MODEL = reference_model()
SENSOR, MARKERS = protocol_sensor(MODEL)
FRAMES, DT, AT = 60, 0.01, 30
EVERYWHERE = np.zeros(MODEL.nv, dtype=bool)
NAMES = tuple(f"M{m}" for m in range(36))
FITS = LimbFits(SENSOR, np.full(36, 0.005), EVERYWHERE, NAMES)
LEG = next(one for one in FITS.limbs if one.name == "left_thigh")


@pytest.fixture(scope="module")
def course():
    return smooth_motion(MODEL, np.random.default_rng(1), swing_rad=0.15).frames(FRAMES, 1.0 / DT)[0]


class Thrown(TrackingFilter):
    """Turns the left thigh over in one frame."""

    thrown = False

    def step(self, before, recording, t, prediction=None):
        found = super().step(before, recording, t, prediction)
        if t < AT or self.thrown:
            return found
        self.thrown = True
        q = turned_over(MODEL, found.q, *LEG.joints[:2])
        return found._replace(q=q, record=found.record._replace(state=replace(found.record.state, q=q)))


def tracked(positions, kind=TrackingFilter, smoothing=None):
    kalman = KinematicFilter(SENSOR, np.full(36, 0.005), DT, EVERYWHERE, KinematicSettings())
    recording = Recording(positions, np.zeros((len(positions), 0, 6)), DT)
    filter = kind(KinematicReport(kalman), WarmStart(kalman, FITS))
    return track(filter, recording, smoothing=smoothing, spreads=())


def off(found, course, frames):
    pairs = zip(course[frames], found.q[frames], strict=True)
    return max(np.abs(MODEL.difference(a, b)[LEG.dofs]).max() for a, b in pairs)


def test_a_clean_track_has_no_doubts(course):
    positions = marker_positions(SENSOR, course)
    found = tracked(positions)
    assert found.limb_doubts == () and found.starts == (0,)


@pytest.mark.parametrize("smoothing", [None, SmoothingSettings()])
def test_a_thigh_turned_over_is_set_right_and_stated(course, smoothing):
    found = tracked(marker_positions(SENSOR, course), Thrown, smoothing)
    (doubt,) = found.limb_doubts
    assert (doubt.limb, doubt.kind, doubt.mended) == ("left_thigh", "turned over", True)
    assert doubt.misfit_m > 0.02
    first = AT if smoothing else AT + 3
    assert off(found, course, slice(first, None)) < np.radians(8.0)
    assert doubt.right_from_s == pytest.approx((AT if smoothing else AT + 1) * DT)


def test_names_of_both_sides_are_put_right_and_stated(course):
    positions, order = marker_positions(SENSOR, course), np.arange(36)
    for a, b in opposite_markers(SENSOR).items():
        if FITS.on_limb[FITS.limbs.index(LEG), a]:
            order[a], order[b] = b, a
    positions[AT:] = positions[AT:, order]
    found = tracked(positions)
    assert off(found, course, slice(AT, None)) < np.radians(8.0)
    (doubt,) = found.limb_doubts
    assert doubt.kind == "names exchanged" and doubt.right_from_s == pytest.approx(AT * DT)
    pairs = {(NAMES[m], NAMES[order[m]]) for m in range(36) if order[m] > m}
    assert set(doubt.exchanged) == pairs


def test_a_limb_that_cannot_be_set_right_is_stated(course):
    positions = marker_positions(SENSOR, course)
    foot = np.flatnonzero(np.array(SENSOR.segments) == "left_shank")
    positions[AT:, foot] += np.random.default_rng(2).normal(size=(len(foot), 3)) * 0.15
    (doubt, *_) = tracked(positions).limb_doubts
    assert not doubt.mended and doubt.from_s >= (AT - 1) * DT and doubt.right_from_s is None


def test_doubt_is_by_markers_or_by_ranges_where_markers_are_seen():
    def evidence(**other):
        usual = {
            "seen": [8], "misfit_m": [0.01], "segment_m": [0.01], "others_m": [0.01], "beyond_rad": [0.0], "dof": [0],
        }  # fmt: skip
        return LimbEvidence(**{name: np.array(one) for name, one in (usual | other).items()})

    assert not in_doubt(evidence())[0]
    assert in_doubt(evidence(segment_m=[0.04]))[0]
    assert not in_doubt(evidence(segment_m=[0.04], others_m=[0.03]))[0]
    assert in_doubt(evidence(beyond_rad=[0.3]))[0]
    assert not in_doubt(evidence(beyond_rad=[0.3], seen=[2]))[0]


def test_a_doubt_that_goes_on_is_stated_before_it_ends(course):
    positions = marker_positions(SENSOR, course)
    foot = np.flatnonzero(np.array(SENSOR.segments) == "left_shank")
    positions[:, foot] += np.random.default_rng(2).normal(size=(len(foot), 3)) * 0.15
    watch, estimate = LimbWatch(FITS, DT), SimpleNamespace(started=False, record=SimpleNamespace(step=None))
    stated = []
    for t in range(FRAMES):
        watch.look(t, SimpleNamespace(q=course[t], **vars(estimate)), positions[t])
        stated.append(len(watch.so_far(t)))
    assert watch.doubts == [] and stated[0] == 0 and stated[-1] == 1
    doubt = watch.so_far(FRAMES)
    watch.finish(FRAMES)
    assert tuple(watch.doubts) == doubt == watch.so_far(FRAMES)


@pytest.mark.parametrize(("off_m", "stated"), [(0.04, 0), (0.15, 1)])
def test_a_short_doubt_is_stated_where_the_limb_is_far(course, off_m, stated):
    positions = marker_positions(SENSOR, course)
    shank = np.flatnonzero(np.array(SENSOR.segments) == "left_shank")
    directions = np.random.default_rng(2).normal(size=(len(shank), 3))
    positions[AT : AT + 3, shank] += off_m * directions / np.linalg.norm(directions, axis=1)[:, None]
    watch, estimate = LimbWatch(FITS, DT), SimpleNamespace(started=False, record=SimpleNamespace(step=None))
    for t in range(FRAMES):
        watch.look(t, SimpleNamespace(q=course[t], **vars(estimate)), positions[t])
    assert len(watch.doubts) == stated
    assert [one.to_s for one in watch.doubts] == pytest.approx([(AT + 3) * DT] * stated)
