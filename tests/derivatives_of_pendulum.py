"""Cases of tests/test_jacobians.py: the double pendulum twice, and states that push nothing."""

from functools import partial

from benchmarks.double_pendulum.forced_bodies import WithIdleStates
from benchmarks.double_pendulum.pendulum import DoublePendulum, PendulumShape
from benchmarks.double_pendulum.pinocchio_pendulum import PinocchioPendulum
from tests.derivatives import checks, named, slope

IDLE = "benchmarks.double_pendulum.forced_bodies.WithIdleStates"


def loaded(rng, make, extra=0):
    body = make(PendulumShape(), residual=True)
    return body, rng.normal(size=4), 3.0 * rng.normal(size=4), 100.0 * rng.normal(size=body.nu + extra)


def linearised(body, q, v, u):
    """Stated and numeric derivatives of an acceleration, by q, v and u."""
    found = body.linearise(q, v, u)
    stated = [found.by_q, found.by_v, found.by_u]
    numeric = [
        slope(partial(body.acceleration, v=v, u=u), q),
        slope(partial(body.acceleration, q, u=u), v),
        slope(partial(body.acceleration, q, v), u, 1.0),
    ]
    return stated, numeric


def joined(parts):
    """All parts side by side."""
    return [row for part in parts for row in part.T]


def manifold(block, body, q, v):
    stated = body.retraction(q, v)
    numeric = [slope(lambda at: body.integrate(at, v), q), slope(lambda at: body.integrate(q, at), v)]
    return {f"{block}.retraction": (stated, numeric)}


@checks("benchmarks.double_pendulum.forced_bodies.PlainCoordinates.retraction")
def plain_coordinates(rng):
    body, q, v, _ = loaded(rng, DoublePendulum)
    return manifold("benchmarks.double_pendulum.forced_bodies.PlainCoordinates", body, q, v)


@checks("benchmarks.double_pendulum.pendulum.DoublePendulum.linearise")
def natural_coordinates(rng):
    body, q, v, u = loaded(rng, DoublePendulum)
    stated, numeric = map(joined, linearised(body, q, v, u))
    return {"benchmarks.double_pendulum.pendulum.DoublePendulum.linearise": (stated, numeric)}


@checks("benchmarks.double_pendulum.pinocchio_pendulum.PinocchioPendulum.linearise")
def pinocchio_pendulum(rng):
    body, q, v, u = loaded(rng, PinocchioPendulum)
    stated, numeric = map(joined, linearised(body, q, v, u))
    return {"benchmarks.double_pendulum.pinocchio_pendulum.PinocchioPendulum.linearise": (stated, numeric)}


@checks(
    "benchmarks.double_pendulum.forced_bodies.WithIdleStates.linearise",
    "benchmarks.double_pendulum.forced_bodies.WithIdleStates.retraction",
)
def idle_states(rng):
    own, q, v, u = loaded(rng, DoublePendulum, extra=3)
    body = WithIdleStates(own, 3)
    stated, numeric = map(joined, linearised(body, q, v, u))
    return {f"{IDLE}.linearise": (stated, numeric)} | manifold(IDLE, body, q, v)


@checks(
    "benchmarks.double_pendulum.pendulum.DoublePendulum.inertial",
    *(f"benchmarks.double_pendulum.pendulum.Inertial.by_{x}" for x in "qva"),
)
def pendulum_inertia(rng):
    body, q, v, _ = loaded(rng, DoublePendulum)
    a = 10.0 * rng.normal(size=4)
    found = body.inertial(q, v, a)
    by_q = slope(lambda at: body.inertial(at, v, a).force, q)
    return named(
        "benchmarks.double_pendulum.pendulum",
        ("DoublePendulum.inertial", found.by_q, by_q),
        ("Inertial.by_q", found.by_q, by_q),
        ("Inertial.by_v", found.by_v, slope(lambda at: body.inertial(q, at, a).force, v)),
        ("Inertial.by_a", found.by_a, slope(lambda at: body.inertial(q, v, at).force, a)),
    )


@checks(
    "benchmarks.double_pendulum.pendulum.DoublePendulum.on_bars",
    "benchmarks.double_pendulum.pendulum.PointReading.jacobian",
)
def points_on_bars(rng):
    body, q, _, _ = loaded(rng, DoublePendulum)
    share, bar = rng.uniform(size=5), rng.integers(1, 3, size=5)
    stated = body.on_bars(q, share, bar).jacobian
    numeric = slope(lambda at: body.on_bars(at, share, bar).positions_m, q)
    return named(
        "benchmarks.double_pendulum.pendulum",
        ("DoublePendulum.on_bars", stated, numeric),
        ("PointReading.jacobian", stated, numeric),
    )
