"""Errors by the body against poses that are fitted again, motions that are moved, and the dynamics of varied bodies."""

from dataclasses import dataclass

import numpy as np
import pytest

from mbkf.filters import body_errors
from mbkf.filters.body_errors import LOOK_S, BodyErrors
from mbkf.filters.pose_errors import LOOSE
from mbkf.model.human import HumanModel
from mbkf.model.joint_centres import centre_names
from mbkf.model.newton_euler import NewtonEuler
from mbkf.sensors.contact.records import Contact
from mbkf.sensors.flexed_skin import FlexedSkin
from mbkf.sensors.marker_sensor import MarkerSensor
from tests.motions import assert_near, protocol_sensor, random_model, smooth_motion

STEP = 1e-5
"""Step of the finite differences, in units of the error's root."""


@dataclass(frozen=True)
class Case:
    """Errors by one root l of factors, joint centres, places and displacements by flexion, in a motion under loads."""

    errors: BodyErrors
    noise_m: np.ndarray
    factors: np.ndarray
    centres: np.ndarray
    places: np.ndarray
    slides: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    wrenches: np.ndarray

    @property
    def model(self):
        return self.errors.sensor.model

    def varied(self, step):
        """The markers on the body that is wrong by ``step`` times the root."""
        factors = self.model.scale + step * self.factors
        centres = self.model.centres_m + step * self.centres
        body = HumanModel(self.model.description, factors, self.model.mass_kg, centres_m=centres)
        sensor = self.errors.sensor
        shares = FlexedSkin(self.model, sensor.segments).shares(self.q)
        wrong = self.places + np.einsum("md,dmi->mi", shares, self.slides)
        return MarkerSensor(body, sensor.segments, sensor.local_m + step * wrong)

    def at(self, contact=None):
        return self.errors.at(self.q, self.v, self.a, self.wrenches, contact)


def case(*parts):
    """The errors of wrong factors, wrong places, wrong displacements by flexion, or several of them."""
    rng = np.random.default_rng(5)
    drawn = random_model(rng)
    shift = 0.01 * np.random.default_rng(7).normal(size=len(centre_names(drawn.description)))
    model = HumanModel(drawn.description, drawn.scale, drawn.mass_kg, centres_m=shift)
    sensor, names = protocol_sensor(model)
    noise_m = rng.uniform(0.003, 0.015, len(names))
    factors = 0.03 * rng.normal(size=18) * ("factors" in parts)
    places = 0.01 * rng.normal(size=(len(names), 3)) * ("places" in parts)
    size = len(centre_names(model.description))
    centres = 0.005 * np.random.default_rng(6).normal(size=size) * ("centres" in parts)
    skin = FlexedSkin(model, sensor.segments)
    slides = 0.01 * rng.normal(size=(skin.flexions, len(names), 3)) * ("skin" in parts)
    root = np.concatenate([factors, centres, places.ravel(), slides.ravel()])[:, None]
    errors = BodyErrors(sensor, noise_m, root, skin)
    motion = smooth_motion(model, rng)
    wrenches = rng.normal(size=(2, 6)) * [60.0, 60.0, 300.0, 40.0, 40.0, 10.0]
    wrenches[:, 2] = [250.0, 500.0]
    return Case(
        errors,
        noise_m,
        factors,
        centres,
        places,
        slides,
        motion.q(0.4),
        motion.v(0.4),
        motion.a(0.4),
        wrenches,
    )


@pytest.fixture(scope="module")
def both():
    return case("factors", "places", "skin")


def refitted(one, q, step):
    """The pose in which the wrong body's markers fit those of the true body at q best, beside the prior there."""
    model, sensor = one.model, one.varied(step)
    measured, weight = one.errors.sensor.positions(q), np.repeat(one.noise_m**-2.0, 3)
    held = model.posture_sd > 0.0
    prior = LOOSE + np.where(held, 1.0 / np.where(held, model.posture_sd, 1.0) ** 2, 0.0)
    found = q
    for _ in range(3):
        reading = sensor.reading(found)
        H = reading.jacobian.reshape(-1, model.nv)
        away = (measured - reading.positions_m).ravel()
        left = H.T @ (weight * away) - prior * model.difference(q, found)
        found = model.integrate(found, np.linalg.solve((H.T * weight) @ H + np.diag(prior), left))
    return found


def fitted_slope(one):
    """(nv,) the derivative of the fitted pose by the size of the body's error."""
    ends = [one.model.difference(one.q, refitted(one, one.q, sign * STEP)) for sign in (1, -1)]
    return (ends[0] - ends[1]) / (2 * STEP)


def column(one, root):
    """A root of one column; its sign, which no covariance knows, is that of the error."""
    return np.sign(fitted_slope(one) @ one.errors.pose_root(one.q)[:, 0]) * root[:, 0]


@pytest.mark.parametrize("part", ["factors", "centres", "places", "skin"])
def test_a_pose_is_off_as_one_fitted_with_the_wrong_body(part):
    one = case(part)
    assert_near(column(one, one.errors.pose_root(one.q)), fitted_slope(one), 2e-9)


def moved(one, step):
    """q, v and a of the motion whose poses are all put wrong, by differences over the time that rates are taken in."""
    model, h, sign = one.model, LOOK_S, column(one, np.ones((1, 1)))
    wrong = []
    for t in (0.0, h, -h):
        q = model.integrate(one.q, t * one.v + 0.5 * t * t * one.a)
        wrong.append(model.integrate(q, step * sign * one.errors.pose_root(q)[:, 0]))
    here, after, before = wrong
    ahead, behind = model.difference(here, after), model.difference(here, before)
    return here, (ahead - behind) / (2 * h), (ahead + behind) / h**2


def test_velocities_are_off_as_those_of_the_wrong_poses(both):
    ends = [moved(both, sign * 1e-3)[1] for sign in (1, -1)]
    expected = (ends[0] - ends[1]) / 2e-3
    assert_near(
        column(both, both.at().velocity) / np.abs(expected).max(), expected / np.abs(expected).max(), 1e-3
    )


def test_torques_are_off_as_those_of_the_wrong_body_on_the_wrong_motion(both):
    one, tau = both, []
    for step in (1e-3, -1e-3):
        tau.append(NewtonEuler(one.varied(step).model).tau(*moved(one, step), one.wrenches.ravel()))
    expected = (tau[0] - tau[1]) / 2e-3
    found = column(one, one.at().torque)
    assert_near(found / np.abs(expected).max(), expected / np.abs(expected).max(), 4e-4)


def test_the_own_torques_of_a_body_are_those_of_wrong_factors_and_joint_centres():
    """At a motion and loads that are known."""
    one, loads = case("factors", "centres"), 1e-3
    tau = [
        NewtonEuler(one.varied(step).model).tau(one.q, one.v, one.a, one.wrenches.ravel())
        for step in (loads, -loads)
    ]
    expected = (tau[0] - tau[1]) / (2 * loads)
    balance = one.errors._balance.torques(one.q, one.v, one.a, one.wrenches.ravel())
    found = column(one, one.errors._own_torques(one.q, one.v, one.a, one.wrenches.ravel(), balance))
    assert_near(found / np.abs(expected).max(), expected / np.abs(expected).max(), 1e-4)


@pytest.mark.parametrize("contact", [(Contact.UNMEASURED, Contact.MEASURED), (Contact.UNMEASURED,) * 2])
def test_what_no_plate_reads_closes_newtons_law(both, contact):
    """The root's residual does not err, and each foot errs as it bears; a plate's reading is as it is."""
    read, unread = both.at((Contact.MEASURED,) * 2), both.at(contact)
    assert not read.wrench.any()
    size = np.abs(read.torque[:6]).max()
    assert size > 1.0
    assert_near(unread.torque[:6] / size, 0.0, 1e-12)
    right, left = unread.wrench[:6], unread.wrench[6:]
    share = 1 / 3 if contact[1] == Contact.UNMEASURED else 1.0
    assert_near((1 - share) * right, share * left, 1e-12)
    np.testing.assert_array_equal(unread.position, read.position)


def test_fewer_columns_keep_nearly_all_of_the_variance(monkeypatch):
    rng = np.random.default_rng(1)
    model = random_model(rng)
    sensor, names = protocol_sensor(model)
    count = 18 + len(centre_names(model.description)) + 3 * len(names)
    root, noise_m = 0.01 * rng.normal(size=(count, count)), np.full(len(names), 0.005)
    q = smooth_motion(model, rng).q(0.3)
    kept = BodyErrors(sensor, noise_m, root).pose_root(q)
    monkeypatch.setattr(body_errors, "KEPT_VARIANCE", 1.0)
    everything = BodyErrors(sensor, noise_m, root).pose_root(q)
    assert kept.shape[1] < 0.6 * count
    share = (kept**2).sum(axis=1) / (everything**2).sum(axis=1)
    assert (share > 0.98).all() and (share <= 1.0 + 1e-9).all()
