"""Cases of tests/test_jacobians.py: sensors, plants, and the readings of the filters."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np

from mbkf.filters.dynamic.support_loads import Loads, SupportLoads
from mbkf.filters.torque.integrators import INTEGRATORS, Motion
from mbkf.filters.torque.plant import ForcedState, Scheme, TorquePlant
from mbkf.model.layout import SUPPORT
from mbkf.model.newton_euler import NewtonEuler
from mbkf.sensors.block import Frame
from mbkf.sensors.foot_wrench import FootWrenchSensor
from mbkf.sensors.joint_limits import JointLimits, JointLimitSettings
from mbkf.sensors.markers import Markers
from mbkf.sensors.posture import PosturePrior, PostureSettings, posture_information
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.sensors.supports.block import Supports
from mbkf.sensors.supports.sharing import shares
from tests.derivatives import checks, named, slope
from tests.derivatives_of_bodies import forced_body
from tests.dynamics import LOAD, block_of, dynamic_filter, markers_of, random_state, singer, standing
from tests.motions import central_difference, moderate_pose, protocol_sensor, random_model

DT = 0.01


# Sensors.


@checks(
    "sensors.marker_sensor.MarkerReading.jacobian",
    "sensors.marker_sensor.MarkerSensor.reading",
)
def markers(rng):
    model = random_model(rng)
    sensor, q = protocol_sensor(model)[0], moderate_pose(model, rng, spread=1.0)
    reading = sensor.reading(q)
    by_q = central_difference(model, sensor.positions, q)
    return named(
        "sensors.marker_sensor",
        ("MarkerReading.jacobian", reading.jacobian, by_q),
        ("MarkerSensor.reading", reading.jacobian, by_q),
    )


@checks(
    "sensors.posture_sensor.PostureReading.jacobian",
    "sensors.posture.PreparedPosture.jacobian",
    "sensors.posture_sensor.PostureSensor.reading",
    "sensors.posture_sensor.PostureSensor.deviation",
    "sensors.posture_sensor.PostureSensor.from_posture",
    "sensors.posture.posture_information",
)
def posture(rng):
    model = random_model(rng)
    sensor, q = PostureSensor(model), moderate_pose(model, rng, spread=1.0)
    numeric = central_difference(model, lambda at: sensor.deviation(at)[0], q)
    read = central_difference(model, lambda at: sensor.reading(at).deviation, q)
    weights, start = rng.uniform(0.5, 2.0, model.nv), moderate_pose(model, rng, spread=0.5)
    away = central_difference(model, lambda at: sensor.from_posture(start, at)[0], q)
    prior = PosturePrior(sensor, np.zeros(model.nv, dtype=bool), PostureSettings())

    def squared(at):
        return 0.5 * np.sum((weights * sensor.deviation(at)[0]) ** 2)

    return named(
        "sensors.posture_sensor",
        ("PostureReading.jacobian", sensor.reading(q).jacobian, read),
        ("PostureSensor.reading", sensor.reading(q).jacobian, numeric[sensor.dofs]),
        ("PostureSensor.deviation", sensor.deviation(q)[1], numeric),
        ("PostureSensor.from_posture", sensor.from_posture(start, q)[1], away),
    ) | named(
        "sensors.posture",
        ("PreparedPosture.jacobian", prior.prepare(SimpleNamespace(q=q), None).jacobian, numeric),
        # Half the square of the weighed deviations falls along the vector.
        (
            "posture_information",
            posture_information(*sensor.deviation(q), weights).vector,
            -central_difference(model, squared, q),
        ),
    )


@checks("sensors.joint_limits.JointLimits.information")
def joint_limits(rng):
    """Passed limits pull down the slope of ½ Σ (beyond / sd)²."""
    model = random_model(rng)
    sensor = PostureSensor(model)
    limits = JointLimits(sensor, np.zeros(model.nv, dtype=bool), JointLimitSettings(0.5))
    step = np.minimum(2.37 * model.posture_sd, 1.13) * rng.choice([-1.0, 1.0], model.nv)
    q = model.integrate(model.neutral(), step)

    def energy(at):
        deviation = sensor.deviation(at)[0]
        beyond = np.maximum(deviation - limits.upper, 0.0) + np.maximum(limits.lower - deviation, 0.0)
        return 0.5 * np.sum((beyond / limits.sd_rad) ** 2)

    vector = limits.information(*sensor.deviation(q)).vector
    return named(
        "sensors.joint_limits.JointLimits", ("information", -vector, central_difference(model, energy, q))
    )


@checks(
    "sensors.foot_wrench.WrenchReading.by_q", "sensors.foot_wrench.WrenchReading.by_state", tolerance=1e-6
)
def plates(rng):
    body, q, _, _, u = forced_body(rng)
    sensor, points, state = FootWrenchSensor(body), 0.3 * rng.normal(size=(2, 3)), u[-12:]
    found = sensor.reading(q, state, points)
    by_q = central_difference(body.model, lambda at: sensor.reading(at, state, points).wrench, q)
    by_state = slope(lambda at: sensor.reading(q, at, points).wrench, state, 1e-2)
    return named(
        "sensors.foot_wrench.WrenchReading",
        ("by_q", found.by_q, by_q),
        ("by_state", found.by_state, by_state),
    )


# Plants and filters.


@checks("filters.filter.Filter.linearise", "filters.readings.Readings.rows", tolerance=1e-6)
def dynamic_readings(rng):
    """Whitened innovations fall by the rows; without priors, what markers say falls by their information."""
    model = random_model(rng)
    kalman = dynamic_filter(model, plates=2, posture_scale=1e6, limit_sd_rad=1e6)
    s = random_state(model, rng, standing(model), spread=0.05)
    hidden = markers_of(kalman, s.q)
    hidden[np.isin(kalman.sensor.segments, ["right_hand"])] = np.nan
    done = kalman.step(s, kalman.begin(), Frame(hidden, np.zeros((2, 6))))
    assert len(done.decisions.notes.unobserved)
    k = block_of(kalman, Markers)[1]
    # The same decision, of markers that lie where the state has them.
    decided = list(done.decisions.blocks)
    decided[k] = decided[k]._replace(measured_m=markers_of(kalman, s.q))
    decisions = done.decisions._replace(blocks=decided)

    def read(x):
        return kalman.linearise(kalman.plant.retract(s, x, s.P), decisions)

    zero = np.zeros(len(s.P))
    found = read(zero)
    falls = -slope(lambda x: read(x).values, zero, 1e-5)
    informs = -slope(lambda x: read(np.r_[x, zero[model.nv :]]).vector, zero[: model.nv])
    return {
        "filters.readings.Readings.rows": (found.rows, falls),
        "filters.filter.Filter.linearise": (found.matrix / 1e6, informs / 1e6),
    }


def flow(body, now, u, h, x):
    """Where an exact step of length h leads from a state that is x (n,) away in its tangent space."""
    nv = body.nv
    start = Motion(body.integrate(now.q, x[:nv]), now.v + x[nv : 2 * nv])
    return INTEGRATORS["RK4"](body, start, u + x[2 * nv :], h)


def flow_derivative(body, now, u, h):
    """(2 nv, n) its derivative, forces changed in larger steps than motions."""
    centre, n = flow(body, now, u, h, np.zeros(2 * body.nv + body.nu)), 2 * body.nv + body.nu
    size = np.where(np.arange(n) < 2 * body.nv, 1.0, 100.0)

    def tangent(x):
        end = flow(body, now, u, h, size * x)
        return np.concatenate([body.difference(centre.q, end.q), end.v - centre.v])

    return slope(tangent, np.zeros(n)) / size


@checks("filters.torque.plant.TorquePlant.sensitivity", tolerance=1e-5)
def torque_sensitivity(rng):
    """F is the rate at which errors change along the manifold."""
    body, q, v, _, u = forced_body(rng)
    plant, now = TorquePlant(body, DT, lambda _: np.zeros(()), Scheme()), Motion(q, v)

    def rate(h):
        forth, back = (flow_derivative(body, now, u, s * h) for s in (1.0, -1.0))
        return (forth - back) / (2.0 * h)

    stated = plant.sensitivity(v, body.linearise(q, v, u))[: 2 * body.nv]
    numeric = (4.0 * rate(1e-4) - rate(2e-4)) / 3.0
    return named("filters.torque.plant.TorquePlant", ("sensitivity", stated, numeric))


@checks("filters.torque.plant.ForcedPrediction.phi", tolerance=1e-4)
def torque_transition(rng):
    """With F averaged over a short step, exp(F Δt) is Φ to second order."""
    body, q, v, _, u = forced_body(rng)
    n, dt = 2 * body.nv + body.nu, 1e-3
    plant = TorquePlant(body, dt, lambda _: np.zeros((n, n)), Scheme("RK4", mean_slope=True))
    state, numeric = ForcedState(q, v, u, np.zeros((n, n))), flow_derivative(body, Motion(q, v), u, dt)
    return named(
        "filters.torque.plant.ForcedPrediction", ("phi", plant.predict(state).phi[: 2 * body.nv], numeric)
    )


# Other contacts than the feet's.


def some_parts(rng):
    """Middles and levers of three parts, all of which may pull."""
    return rng.uniform(-0.5, 0.5, (3, 3)), rng.uniform(0.05, 0.15, 3), [True] * 3


@checks("sensors.supports.sharing.Shares.by_whole")
def shared_wrench(rng):
    parts, whole = some_parts(rng), rng.normal(size=6) * LOAD
    numeric = slope(lambda w: shares(w, *parts).wrench, whole, 1e-2)
    return named("sensors.supports.sharing.Shares", ("by_whole", shares(whole, *parts).by_whole, numeric))


@checks("filters.dynamic.support_loads.SupportLoads.torques", tolerance=1e-6)
def torques_of_all_contacts(rng):
    """Along the whole state, the parts' middles held: a configuration moves bodies under loads that stay."""
    model = random_model(rng)
    plant = singer(model, Supports(model, DT).states())
    reader, balance, s = SupportLoads(model, plant.layout), NewtonEuler(model), random_state(model, rng)
    s, parts = replace(s, extra=rng.normal(size=6) * LOAD), some_parts(rng)
    chosen = tuple(int(k) for k in rng.choice(len(reader.bearings), 3, replace=False))

    def found(at):
        torque = balance.torques(at.q, at.v, at.a, at.w)
        loads = Loads(chosen, shares(at.extra, *parts))
        return torque, reader.torques(balance, torque, loads)[0]

    size = np.where(np.arange(plant.layout.size) < plant.layout.a.start, 1.0, 1e3)
    numeric = (
        slope(lambda x: found(plant.retract(s, size * x, s.P))[0].tau, np.zeros(plant.layout.size)) / size
    )
    assert plant.layout[SUPPORT].stop == len(size)
    return named("filters.dynamic.support_loads.SupportLoads", ("torques", found(s)[1], numeric))
