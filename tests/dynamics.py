"""Filters, states and trials for the tests of the dynamic filter and its parts."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from mbkf.conventions import GRAVITY_M_S2
from mbkf.filters.dynamic.filter import DynamicFilter, dynamic_blocks
from mbkf.filters.dynamic.plant import DynamicState, SingerPlant, SingerSettings
from mbkf.filters.dynamic.settings import DynamicSettings
from mbkf.filters.settings import changed
from mbkf.io.records import PlateReadings
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel
from mbkf.model.layout import Layout
from mbkf.sensors.block import Frame, Notes, OperatingPoint
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.contact.soles import sole_points
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.root_residual import RootResidual
from mbkf.synthesis.motion import TrueMotion
from tests.motions import moderate_pose, protocol_sensor
from tests.recordings import performer

DT = 0.01
LOAD = np.array([80.0, 40.0, 500.0, 60.0, 60.0, 20.0])
"""Size of a foot's wrench, N and N m."""

MARKER_SD_M = 0.002

RESIDUAL = RootResidual(GRAVITY_M_S2 * 70.0, DT).states()
"""The state that the standard blocks add."""

RESIDUAL_SD = np.repeat([20.0, 10.0], 3)

SPREAD = (0.02, 0.3, 5.0)
"""How well positions, velocities and accelerations of a random state are known, SI units."""


def random_covariance(model, rng):
    """A covariance (N, N) in which everything depends on everything, and nothing is better known than a third."""
    nv = model.nv
    sd = np.concatenate([np.repeat(SPREAD, nv), np.tile(LOAD, 2) / 10.0, RESIDUAL_SD])
    A = rng.normal(size=(len(sd), len(sd)))
    P = sd[:, None] * (A @ A.T / len(sd) + 0.1 * np.eye(len(sd))) * sd
    return 0.5 * (P + P.T)


def random_state(model, rng, q=None, spread=1.0):
    """A state near a pose (anywhere by default), moving under loads, with a full covariance."""
    nv = model.nv
    q = moderate_pose(model, rng) if q is None else model.integrate(q, spread * 0.1 * rng.normal(size=nv))
    v, a = spread * rng.normal(size=nv), 10.0 * spread * rng.normal(size=nv)
    w = rng.normal(size=12) * np.tile(LOAD, 2)
    return DynamicState(q, v, a, w, random_covariance(model, rng), rng.normal(size=6) * RESIDUAL_SD)


def standing(model, height_m=0.0):
    """The neutral posture with its soles at a height."""
    q = model.neutral()
    q[2] += height_m - sole_points(model, q[None])[0, :, :2, 2].min()
    return q


def plate(x, y, half=(0.3, 0.3), height_m=0.0, name="1", outline=True):
    """An unloaded force plate with its middle at x, y; without an outline if so asked."""
    middle = np.array([x, y, height_m])
    corners = middle + np.array([[1, -1, 0], [-1, -1, 0], [-1, 1, 0], [1, 1, 0]]) * np.array([*half, 0.0])
    nothing = np.zeros((1, 3))
    return PlateReadings(
        name, 1000.0, 0.0, middle, nothing, nothing, nothing, 20.0, corners if outline else None
    )


def plates_under(model, q):
    """One plate under each sole of a standing body."""
    soles = sole_points(model, q[None])[0].mean(axis=1)
    return tuple(plate(x, y, (0.25, 0.08), name=name) for name, (x, y, _) in zip("12", soles, strict=True))


def singer(model, extras=RESIDUAL, held=None, settings=None, dt_s=DT):
    """A Singer plant with states that blocks add; ``held`` dofs stay where they are."""
    held = np.zeros(model.nv, dtype=bool) if held is None else held
    return SingerPlant(model, Layout.dynamic(model.nv, extras), dt_s, held, settings or SingerSettings())


def standard_filter(sensor, noise_m, detector, dt_s, unobservable, settings):
    """The dynamic filter with its standard blocks."""
    blocks = dynamic_blocks(sensor, noise_m, detector, dt_s, unobservable, settings)
    return DynamicFilter(sensor, noise_m, dt_s, unobservable, settings, blocks)


def dynamic_filter(
    model,
    plates=(),
    dt_s=DT,
    noise_m=MARKER_SD_M,
    unobservable=None,
    protocol="reference36",
    keep=None,
    **settings,
):
    """A filter with a protocol's markers; ``plates`` are readings, or 2 for one under each foot of a standing body."""
    if plates == 2:
        plates = plates_under(model, standing(model))
    sensor = protocol_sensor(model, protocol, keep)[0]
    noise = np.full(len(sensor.segments), noise_m)
    unobservable = np.zeros(model.nv, dtype=bool) if unobservable is None else unobservable
    detector = ContactDetector(model, plates, dt_s)
    return standard_filter(sensor, noise, detector, dt_s, unobservable, settings_with(**settings))


def settings_with(**values):
    """The dynamic filter's default settings but for these, by their own names."""
    return changed(DynamicSettings(), **values)


def notes_of(**values):
    """Notes that say this of a frame."""
    notes = Notes()
    for name, value in values.items():
        assert hasattr(notes, name), name
        setattr(notes, name, value)
    return notes


def prepared_at(block, state, memory=None):
    """A state as a block sees it."""
    return OperatingPoint(state, block.prepare(state, memory))


def block_of(kalman, kind):
    """A filter's block of a kind, and its place among the blocks."""
    return next((block, k) for k, block in enumerate(kalman.blocks) if isinstance(block, kind))


def memory_of(kalman, kind, memory):
    """What a filter's block of a kind keeps."""
    return memory.blocks[block_of(kalman, kind)[1]]


def with_memory(kalman, kind, memory, own):
    """The filter's memory with that of a block of a kind replaced."""
    k = block_of(kalman, kind)[1]
    return memory._replace(blocks=(*memory.blocks[:k], own, *memory.blocks[k + 1 :]))


def decision_of(kalman, kind, step):
    """What a filter's block of a kind decided in a step."""
    return step.decisions.blocks[block_of(kalman, kind)[1]]


def markers_of(kalman, q):
    return kalman.sensor.positions(q)


def half_weight(model, points):
    """(2, 6) half of the weight on each of two points (2, 3), about the world's origin."""
    force = np.array([0.0, 0.0, 0.5 * GRAVITY_M_S2 * model.mass_kg])
    return np.array([np.concatenate([force, np.cross(point, force)]) for point in points])


def about(point):
    """(6, 6) that moves a wrench from the world's origin to a point."""
    x, y, z = point
    X = np.eye(6)
    X[3:, :3] = -np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return X


def at_rest(model, q, wrench):
    """A state that rests under a wrench (12,) or (2, 6), with a diagonal covariance."""
    sd, still = _state_sd(model), np.zeros(model.nv)
    wrench = np.asarray(wrench, dtype=float).ravel()
    return DynamicState(q, still, still, wrench, np.diag(sd**2), np.zeros(6))


def _state_sd(model):
    """Standard deviations of a state roughly known."""
    return np.concatenate([np.repeat(SPREAD, model.nv), np.tile(LOAD, 2), RESIDUAL_SD])


@dataclass(frozen=True)
class Trial:
    """A true motion of a made person over force plates.

    Attributes:
        subject, model, motion: Who and what.
        plates: One plate per foot, right and left; both as long as the room, with no outline.
    """

    subject: Subject
    model: HumanModel
    motion: TrueMotion
    plates: tuple[PlateReadings, ...]

    def detector(self, plates=None):
        """The contact detector over these plates, or over others."""
        return ContactDetector(
            self.model, self.plates if plates is None else plates, 1.0 / self.motion.rate_hz
        )

    def kalman(self, noise_m=MARKER_SD_M, plates=None, **settings):
        """A filter that knows body, markers and plates exactly."""
        local = np.array([marker.position_m for marker in self.subject.markers])
        sensor = MarkerSensor(self.model, [marker.segment for marker in self.subject.markers], local)
        everywhere, noise = np.zeros(self.model.nv, dtype=bool), np.full(len(local), noise_m)
        detector, dt_s = self.detector(plates), 1.0 / self.motion.rate_hz
        return standard_filter(sensor, noise, detector, dt_s, everywhere, settings_with(**settings))

    def state(self, t, rng=None):
        """The state at a frame and a covariance; with a generator, wrong by as much as that says."""
        m, nv, sd = self.motion, self.model.nv, _state_sd(self.model)
        step = np.zeros(len(sd)) if rng is None else sd * rng.normal(size=len(sd))
        q = self.model.integrate(m.q[t], step[:nv])
        v, a = m.v[t] + step[nv : 2 * nv], m.a[t] + step[2 * nv : 3 * nv]
        wrench, residual = step[3 * nv : -6], step[-6:]
        return DynamicState(q, v, a, m.foot_wrench[t].ravel() + wrench, np.diag(sd**2), residual)


SECONDS = {"squat": 2.0, "walk": 1.5, "jump": 2.5, "sit_to_stand": 2.6}


@cache
def trial(name):
    """A squat, a walk, a jump or standing up from a chair, made once."""
    subject, model, motion = performer(name, SECONDS[name], 5)
    ground = tuple(plate(0.0, 0.0, name=name, outline=False) for name in ("r", "l"))
    return Trial(subject, model, motion, ground)


@dataclass(frozen=True)
class Run:
    """A filter that followed some frames of a trial.

    Attributes:
        trial, kalman: Whom and with what.
        frames: Frames of the trial.
        begin: State before the first step, at the frame before.
        markers_m: (n, M, 3) what the cameras saw.
        steps: One per frame.
    """

    trial: Trial
    kalman: DynamicFilter
    frames: range
    begin: DynamicState
    markers_m: np.ndarray
    steps: list

    @property
    def states(self):
        return [step.state for step in self.steps]


def camera_markers(kalman, qs, rng, sd_m=MARKER_SD_M):
    """(T, M, 3) markers with white noise."""
    exact = np.array([kalman.sensor.positions(q) for q in qs])
    return exact + sd_m * rng.normal(size=exact.shape)


def follow(made, frames, plates=None, seed=0, **settings):
    """Runs a filter over frames of a trial from a state roughly known; plates read the truth with a newton of noise."""
    rng, m = np.random.default_rng(seed), made.motion
    kalman = made.kalman(plates=plates, **settings)
    markers = camera_markers(kalman, m.q[frames.start : frames.stop], rng)
    begin = made.state(frames.start - 1, rng)
    known = 2 if plates is None else len(plates)
    loads = m.foot_wrench[frames.start : frames.stop, :known]
    loads = loads + (np.abs(loads).sum(axis=2, keepdims=True) > 0) * rng.normal(size=loads.shape)
    state, memory, steps = begin, kalman.begin(), []
    for seen, load in zip(markers, loads, strict=True):
        steps.append(kalman.step(state, memory, Frame(seen, load)))
        state, memory = steps[-1].state, steps[-1].memory
    return Run(made, kalman, frames, begin, markers, steps)
