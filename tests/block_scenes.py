"""Scenes in which the tests of every block show it frames: a walk, its instruments, and what blocks are made with.

The arguments of a block's constructor are filled by their type, by their name, or by their default
(:meth:`Scene.arguments`); a frame has something to read under every name (:class:`AnyReading`).
"""

import inspect
from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, is_dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple, get_type_hints

import numpy as np

from mbkf.conventions import GRAVITY_M_S2
from mbkf.filters.dynamic.plant import DynamicState
from mbkf.filters.torque.plant import ForcedState, Scheme, TorquePlant
from mbkf.imu.frames import matrix_quaternion
from mbkf.imu.placement import typical_mounts
from mbkf.model.human_dynamics import HumanDynamics
from mbkf.model.newton_euler import NewtonEuler
from mbkf.sensors.block import Frame, Notes, OperatingPoint
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.foot_contact import FootContact
from mbkf.sensors.inertial import InertialSensors
from mbkf.sensors.inertial_sensor import InertialSensor
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.markers import Markers
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.sensors.worn_orientations import ORIENTATIONS
from tests.dynamics import DT, LOAD, MARKER_SD_M, SPREAD, singer, trial

LAST, LIVED = 130, 115
"""A frame of the walk in which a foot stands on its plate, and how many frames a block has seen by then."""

STEP = 142
"""A frame in which the load passes from foot to foot."""

HIDDEN = ("hand", "forearm", "upper_arm", "foot", "toes", "head")
"""Segments out of sight in the last frames of some situations."""

NO_IMUS, NO_NAMES = None, {}


SIZES = {"goniometer": 1}
"""Numbers in the readings of blocks that do not read three."""


class AnyReading(Mapping):
    """Readings (3,) under every name but those of :data:`SIZES`, the same whenever asked; all NaN if so asked.

    Orientations are those given.
    """

    def __init__(self, orientations, missing=False):
        self._missing, self._orientations = missing, orientations

    def __getitem__(self, name):
        if name == ORIENTATIONS:
            return np.full_like(self._orientations, np.nan) if self._missing else self._orientations
        if self._missing:
            return np.full(SIZES.get(name, 3), np.nan)
        return 0.1 * np.random.default_rng(sum(name.encode())).normal(size=SIZES.get(name, 3))

    def __contains__(self, name):
        return True

    def __iter__(self):
        return iter(())

    def __len__(self):
        return 0


class Motion(NamedTuple):
    """True motion of a frame: q (nq,), v and a (nv,), wrenches of the feet (2, 6)."""

    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    wrench: np.ndarray


@dataclass(frozen=True)
class Situation:
    """Frames with true motion and what the standard instruments note of each; the last is the one that is read."""

    motion: list
    frames: list
    notes: list

    def noted(self, t=-1):
        """The notes of a frame, to be written into."""
        return copy(self.notes[t])


class Scene:
    """A walk over two plates with markers and inertial sensors, its instruments in one order or another."""

    def __init__(self, seed=None):
        walk, rng = trial("walk"), np.random.default_rng(seed)
        self.walk, self.model = walk, walk.model
        mounts = typical_mounts(self.model, seed=1)
        counts = (len(walk.subject.markers), len(walk.plates), len(mounts))
        self.order = [np.arange(n) if seed is None else rng.permutation(n) for n in counts]
        markers = [walk.subject.markers[k] for k in self.order[0]]
        local = np.array([marker.position_m for marker in markers])
        self.sensor = MarkerSensor(self.model, [marker.segment for marker in markers], local)
        self.inertial = InertialSensor(self.model, [mounts[k] for k in self.order[2]])
        self.detector = ContactDetector(self.model, [walk.plates[k] for k in self.order[1]], DT)
        self.noise_m = np.linspace(0.5, 1.5, counts[0])[self.order[0]] * MARKER_SD_M
        self.everywhere = np.zeros(self.model.nv, dtype=bool)
        self.body = HumanDynamics(self.model, self.everywhere)
        self._situations = {}

    @cached_property
    def by_type(self):
        """Arguments of constructors by their type."""
        return {
            type(self.model): self.model,
            MarkerSensor: self.sensor,
            InertialSensor: self.inertial,
            PostureSensor: PostureSensor(self.model),
            ContactDetector: self.detector,
            NewtonEuler: NewtonEuler(self.model),
            HumanDynamics: self.body,
        }

    @cached_property
    def by_name(self):
        """Arguments of constructors by their name."""
        movement = self.model.movement_sd
        return {
            "noise_m": self.noise_m,
            "dt_s": DT,
            "unobservable": self.everywhere,
            "weight_n": GRAVITY_M_S2 * self.model.mass_kg,
            "movement_sd": movement,
            "velocity_sd": 0.1 * movement,
            "acceleration_sd": 10.0 * movement,
            "residual_sd": np.repeat([10.0, 5.0], 3),
            "bias_rad_s": np.zeros((len(self.order[2]), 3)),
            "bias_sd_rad_s": np.full((len(self.order[2]), 3), 0.01),
            "turn_sd_rad": np.full((len(self.order[2]), 3), 0.1),
        }

    def arguments(self, kind):
        """What a block is made with: by type, by name, by default; settings as they come, other numbers 0.5."""
        found, hints = {}, get_type_hints(kind.__init__)
        for name, one in inspect.signature(kind).parameters.items():
            hint = hints.get(name)
            if hint in self.by_type:
                found[name] = self.by_type[hint]
            elif name in self.by_name and (hint is not float or isinstance(self.by_name[name], float)):
                found[name] = self.by_name[name]
            elif name == "model":
                found[name] = self.model
            elif one.default is not inspect.Parameter.empty:
                found[name] = one.default
            elif is_dataclass(hint):
                found[name] = hint()
            elif hint is float:
                found[name] = 0.5
            else:
                raise TypeError(f"{kind.__name__}: give '{name}' a default or a value in Scene.by_name")
        return found

    def made(self, kind, **changes):
        """A block, bound to the layout and body of a filter that holds it."""
        block = kind(**(self.arguments(kind) | changes))
        block.bind(self.plant(block).layout, self.model)
        return block

    def plant(self, block):
        """A plant whose states the block speaks of: accelerations, or forces where it asks for a forced body."""
        if HumanDynamics in get_type_hints(type(block).__init__).values():
            return TorquePlant(self.body, DT, lambda _: np.zeros(()), Scheme(), wrenches=True)
        return singer(self.model, block.states())

    def state(self, true, plant, P):
        """A true motion as the plant's state, with a covariance, and what blocks add at its start."""
        q, v, a, wrench = true
        if isinstance(plant, TorquePlant):
            return ForcedState(q, v, self.body.forces(q, v, a, wrench), P)
        return DynamicState(q, v, a, wrench.ravel(), P, plant.layout.start()[0])

    def frame(self, t, hidden=False, worn=False):
        """Exact readings of a frame; the hidden segments out of sight, and inertial sensors worn, if so asked."""
        m = self.walk.motion
        markers = self.sensor.positions(m.q[t])
        if hidden:
            markers[[segment.endswith(HIDDEN) for segment in self.sensor.segments]] = np.nan
        imus = self.inertial.values(m.q[t], m.v[t], m.a[t]) if worn else NO_IMUS
        turns = matrix_quaternion(self.inertial.orientations(m.q[t]))
        return Frame(markers, m.foot_wrench[t][self.order[1]], imus, AnyReading(turns))

    def situation(self, name):
        """Everything seen; limbs hidden; hidden, with inertial sensors; joints bent too far; a step without plates;
        nothing read at last.
        """
        if name not in self._situations:
            self._situations[name] = self._made_situation(name)
        return self._situations[name]

    def _made_situation(self, name):
        hides, worn = name in ("hidden", "worn"), name == "worn"
        last = STEP if name == "step" else LAST
        times = range(last - LIVED, last + 1)
        frames = [self.frame(t, hides and t > LAST - 3, worn) for t in times]
        if name == "step":
            frames = [frame._replace(plates=np.full_like(frame.plates, np.nan)) for frame in frames]
        m = self.walk.motion
        motion = [Motion(m.q[t], m.v[t], m.a[t], m.foot_wrench[t]) for t in times]
        if name == "bent":
            motion[-1] = motion[-1]._replace(q=bent(self.model))
        if name.startswith("nothing"):
            frames[-1] = self.nothing(absent=name == "nothing there")
        return Situation(motion, frames, self._noted(motion, frames))

    def nothing(self, absent):
        """A frame in which no instrument reads; absent ones are not even named."""
        markers, plates = np.full((len(self.noise_m), 3), np.nan), np.full((len(self.order[1]), 6), np.nan)
        imus = None if absent else np.full((len(self.order[2]), 6), np.nan)
        turns = np.full((len(self.order[2]), 4), np.nan)
        return Frame(markers, plates, imus, NO_NAMES if absent else AnyReading(turns, missing=True))

    def near(self, true, plant, seed):
        """A state a little off the true motion, with a full covariance; what blocks add is as they start."""
        rng, nv = np.random.default_rng(seed), self.model.nv
        if isinstance(plant, TorquePlant):
            sd = np.concatenate([np.repeat(SPREAD[:2], nv), np.full(self.body.nu, 5.0)])
        else:
            sd = np.concatenate([np.repeat(SPREAD, nv), 0.1 * np.tile(LOAD, 2), plant.layout.start()[1]])
        A = rng.normal(size=(len(sd), len(sd)))
        P = 0.01 * sd[:, None] * (A @ A.T / len(sd) + 0.1 * np.eye(len(sd))) * sd
        state = self.state(true, plant, np.asfortranarray(0.5 * (P + P.T)))
        return plant.retract(state, 0.05 * sd * rng.normal(size=len(sd)), state.P)

    def _noted(self, motion, frames):
        """What markers, plates and inertial sensors note, frame by frame."""
        standard = [self.made(kind) for kind in (Markers, FootContact, InertialSensors)]
        kept, found = [block.begin() for block in standard], []
        plant = self.plant(standard[0])
        for true, frame in zip(motion, frames, strict=True):
            notes, here = Notes(), self.state(true, plant, 1e-4 * np.eye(plant.layout.size))
            for k, block in enumerate(standard):
                at = OperatingPoint(here, block.prepare(here, kept[k]))
                kept[k] = block.remember(here, at, block.decide(at, frame, kept[k], notes), kept[k])
            found.append(notes)
        return found


def bent(model):
    """Standing with knees and elbows 0.3 rad beyond their nearest limits."""
    step = np.zeros(model.nv)
    for segment in ("right_shank", "left_forearm"):
        own = np.arange(model.nv)[model.joint(segment).v]
        limits = model.limits[own]
        near = limits[np.arange(len(own)), np.abs(limits).argmin(axis=1)]
        k = np.abs(near).argmax()
        step[own[k]] = near[k] + 0.3 * np.sign(near[k])
    return model.integrate(model.neutral(), step)


SITUATIONS = ("seen", "hidden", "worn", "bent")
STEPPING = ("LoadTransfer",)
"""Blocks that are shown a step without plates, too; contacts of the feet then take shares of the state as given."""

SILENT = ("nothing read", "nothing there")
scene = lru_cache(None)(Scene)


def situations_of(name):
    """What a block of this name is shown."""
    return (*SITUATIONS, "step") if name in STEPPING else SITUATIONS
