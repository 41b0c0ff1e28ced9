"""Markers on sliding skin: information of the reading with the frame before taken off, and of markers new in sight."""

import numpy as np
import pytest

from mbkf.numerics.kalman import correct
from mbkf.sensors.marker_sensor import MarkerInformation
from mbkf.sensors.skin import SkinMarkers
from tests.motions import assert_near, moderate_pose, protocol_sensor, reference_model

MODEL = reference_model()
NV = MODEL.nv
SENSOR, _ = protocol_sensor(MODEL)
MARKERS = len(SENSOR.segments)
DT, CAMERA_M, DECAY_S = 0.01, 0.001, 0.3
RHO = np.exp(-DT / DECAY_S)
SD_M = np.linspace(0.003, 0.009, MARKERS)
EVERY = np.ones(MARKERS, dtype=bool)
SKIN = SkinMarkers(SENSOR, SD_M, CAMERA_M, DECAY_S, DT)


class Moment:
    """A body in motion, what was seen of it now and in the frame before, each some millimetres off."""

    def __init__(self, speed=1.0, seed=1):
        rng = np.random.default_rng(seed)
        self.q = moderate_pose(MODEL, rng)
        self.v, self.a = speed * rng.normal(size=NV), speed * 10.0 * rng.normal(size=NV)
        self.reading = SENSOR.reading(self.q)
        self.innovation = 0.005 * rng.normal(size=(MARKERS, 3))
        self.now = self.reading.positions_m + self.innovation
        self.before = predicted_before(self.q, self.v, self.a) + 0.005 * rng.normal(size=(MARKERS, 3))

    def information(self, trusted=EVERY, before=None):
        before = self.before if before is None else before
        return SKIN.at(self.q, self.v, self.a, self.reading, self.innovation, trusted, before)


def predicted_before(q, v, a):
    """Markers in the frame before, for the motion now."""
    return SENSOR.positions(MODEL.integrate(q, 0.5 * a * DT**2 - v * DT))


def differenced(q, v, a):
    """(3 M,) h(q) − ρ h(q before)."""
    return (SENSOR.positions(q) - RHO * predicted_before(q, v, a)).ravel()


def derivative(moment):
    """(3 M, 3 nv) of the differenced reading along q, v and a, by central differences."""
    h, columns = 1e-5, []
    for e in np.eye(3 * NV):
        dq, dv, da = np.split(h * e, 3)
        ends = [
            differenced(MODEL.integrate(moment.q, s * dq), moment.v + s * dv, moment.a + s * da)
            for s in (-1, 1)
        ]
        columns.append((ends[1] - ends[0]) / (2 * h))
    return np.array(columns).T


def expected(moment):
    """Hᵀ R⁻¹ H and Hᵀ R⁻¹ y of the differenced reading."""
    H = derivative(moment)
    variance = SD_M**2 * (1 - RHO**2) + CAMERA_M**2 * (1 + RHO**2)
    weight = np.repeat(1.0 / variance, 3)
    y = (moment.now - RHO * moment.before).ravel() - differenced(moment.q, moment.v, moment.a)
    return H.T @ (weight[:, None] * H), H.T @ (weight * y), float(weight @ y**2)


def relative(found, wanted):
    return np.linalg.norm(found - wanted) / np.linalg.norm(wanted)


PARTS = {"q": slice(0, NV), "v": slice(NV, 2 * NV), "a": slice(2 * NV, 3 * NV)}


def worst_block(moment, parts):
    """Largest relative error of the information's blocks on these parts of the state."""
    found, (matrix, vector, _) = moment.information(), expected(moment)
    errors = [relative(found.vector[PARTS[i]], vector[PARTS[i]]) for i in parts]
    for i in parts:
        errors += [relative(found.matrix[PARTS[i], PARTS[j]], matrix[PARTS[i], PARTS[j]]) for j in parts]
    return max(errors)


def test_information_at_rest_is_that_of_the_differenced_reading():
    assert worst_block(Moment(0.0), "qva") < 1e-6


@pytest.mark.parametrize("speed", [0.1, 1.0, 3.0])
def test_information_in_motion_is_that_of_the_differenced_reading(speed):
    """The body turns between the frames: the Jacobian of the frame before is its own."""
    assert worst_block(Moment(speed), "qva") < 1e-5


def test_innovation_is_that_of_the_differenced_reading():
    """Exactly, however fast: positions before are computed, not linearised."""
    moment = Moment(3.0)
    found = moment.information()
    assert found.innovation == pytest.approx(expected(moment)[2], rel=1e-9)
    assert found.readings == 3 * MARKERS


def test_information_is_symmetric_and_of_no_negative_size():
    matrix = Moment().information().matrix
    assert_near(matrix, matrix.T, 1e-6)
    assert np.linalg.eigvalsh(matrix).min() > -1e-9 * np.linalg.eigvalsh(matrix).max()


def test_markers_first_seen_tell_as_much_as_ever():
    """The plain information with skin and camera noise together, and nothing on velocities."""
    moment = Moment()
    found = moment.information(before=np.full((MARKERS, 3), np.nan))
    plain = MarkerInformation(SENSOR, np.hypot(SD_M, CAMERA_M)).at(moment.reading, moment.innovation, EVERY)
    np.testing.assert_allclose(found.matrix[:NV, :NV], plain.matrix, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(found.vector[:NV], plain.vector, rtol=1e-9, atol=1e-9)
    np.testing.assert_array_equal(found.matrix[NV:], 0.0)
    np.testing.assert_array_equal(found.vector[NV:], 0.0)
    assert found.innovation == pytest.approx(plain.innovation, rel=1e-14)
    assert found.readings == plain.readings


def test_each_marker_is_known_or_new():
    """Information of all is the sum of that of those seen before and those not."""
    moment, old = Moment(), np.arange(MARKERS) % 3 > 0
    before = np.where(old[:, None], moment.before, np.nan)
    whole = moment.information(before=before)
    parts = [moment.information(trusted, before) for trusted in (old, ~old)]
    np.testing.assert_allclose(whole.matrix, parts[0].matrix + parts[1].matrix, rtol=1e-9, atol=1e-6)
    np.testing.assert_allclose(whole.vector, parts[0].vector + parts[1].vector, rtol=1e-9, atol=1e-9)
    assert whole.readings == parts[0].readings + parts[1].readings == 3 * MARKERS


def test_markers_not_trusted_say_nothing():
    moment = Moment()
    trusted = np.arange(MARKERS) < 20
    kept = moment.information(trusted)
    moment.innovation[20:], moment.before[20:] = np.nan, np.nan
    assert_near(moment.information(trusted).vector, kept.vector, 0.0)
    assert kept.readings == 60
    none = moment.information(~EVERY)
    assert none.readings == 0
    np.testing.assert_array_equal(none.matrix, 0.0)


def test_skin_that_stays_where_it_slid_hardly_moves_a_pose_known_before():
    """An artefact seen twice is no news: the pose follows by a fraction of what plain markers make of it."""
    moment = Moment(0.0)
    slid = np.tile([0.005, 0.0, 0.0], (MARKERS, 1))
    moment.innovation, moment.before = slid, predicted_before(moment.q, moment.v, moment.a) + slid
    P = np.diag(np.repeat([0.003, 0.1, 1.0], NV) ** 2)
    plain = MarkerInformation(SENSOR, SD_M).at(moment.reading, slid, EVERY)
    by_skin = correct(P, moment.information()).step[:NV]
    by_plain = correct(P[:NV, :NV], plain).step
    assert np.linalg.norm(by_skin[:3]) < 0.2 * np.linalg.norm(by_plain[:3])
