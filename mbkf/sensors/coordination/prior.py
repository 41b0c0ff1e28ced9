"""Coordination prior, as a block: 0 = q_j ⊖ q̂_j(f) + r and 0 = v_j − v̂_j(f) + r', for joints j out of sight.

Arms swing with the legs, toes bend with the foot. Many times a second the block notes the features f, pose and rates of
trunk and legs, and the rotation and velocity of every other observed joint. When a joint goes out of sight, a ridge
regression on the last seconds (:mod:`mbkf.sensors.coordination.regression`) predicts it from f; the noise is the
regression's error on blocks of time left out, weighted by its correlation time.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.model.body import Body
from mbkf.sensors.block import NO_DOFS, Block, Frame, Notes, OperatingPoint, Rows, State
from mbkf.sensors.coordination.regression import Coordination, learn
from mbkf.sensors.posture_sensor import PostureSensor

NOTED_HZ, BLOCK_S = 25.0, 0.5
"""Rate at which frames are noted, and duration of a block that is left out at a time."""

PACE_S = 0.15
"""A velocity counts as the angle that it covers in this time: about the inverse rate of a stride."""

LEAST_SD_RAD = 0.02
"""Least error of a predicted joint; of its velocity, this per PACE_S."""


@dataclass(frozen=True)
class CoordinationSettings:
    """Regression and its errors. Tuned on public walks and a run with the right arm hidden for 1 s.

    Attributes:
        coordination_memory_s: Duration of movement from which a joint's relation is learnt; 0 for no such prior.
        coordination_ridge_rad: Features that vary by less than this hardly predict.
        coordination_errs_s: Correlation time of the prediction's error.
    """

    coordination_memory_s: float = field(default=5.0, metadata={"zero": True})
    coordination_ridge_rad: float = 0.1
    coordination_errs_s: float = 0.25


class NotedFrame(NamedTuple):
    """A noted frame: its block of time, features (p,), posture and velocity (2 nv,), and dofs observed (nv,)."""

    block: int
    features: Array
    movement: Array
    observed: BoolArray


class Followed(NamedTuple):
    """Relation of a joint to trunk and legs, and columns of its targets: posture, then velocity."""

    relation: Coordination
    columns: NDArray[np.intp]


class CoordinationMemory(NamedTuple):
    """State carried from one frame to the next.

    Attributes:
        frame: Number of frames so far.
        noted: Some of the last frames.
        gone: Numbers of the joints that are out of sight now.
        learned: Relations of these joints, by their number.
    """

    frame: int
    noted: tuple[NotedFrame, ...]
    gone: tuple[int, ...]
    learned: Mapping[int, Followed]


class CoordinationDecision(NamedTuple):
    """Predicted movement of joints out of sight with a learned relation.

    Attributes:
        dofs: (n,) their dofs.
        q: (nq,) a configuration with their posture.
        v: (n,) their velocities.
        q_sd, v_sd: (n,) standard deviations of both, per reading.
        gone: Numbers of the joints out of sight.
        legible: True if trunk and legs are observed, so that the frame may be noted.
        unobserved: Unobserved dofs.
    """

    dofs: NDArray[np.intp]
    q: Array
    v: Array
    q_sd: Array
    v_sd: Array
    gone: tuple[int, ...]
    legible: bool
    unobserved: NDArray[np.intp]


NO_NUMBERS = np.zeros(0)
"""An empty array."""

_ALL_SEEN = CoordinationDecision(NO_DOFS, NO_NUMBERS, NO_NUMBERS, NO_NUMBERS, NO_NUMBERS, (), True, NO_DOFS)
"""Decision while every joint is observed."""
_LOST = _ALL_SEEN._replace(legible=False)


class CoordinationPrior(Block[State, Mapping[int, Followed], CoordinationDecision, CoordinationMemory]):
    """Head, arms and toes, predicted from trunk and legs.

    Attributes:
        dependents: Dofs of each predicted joint.
    """

    prior = True

    def __init__(
        self,
        model: Body,
        dt_s: float,
        unobservable: BoolArray,
        settings: CoordinationSettings = CoordinationSettings(),
    ) -> None:
        """Makes the block.

        Args:
            model: The body.
            dt_s: Time between frames.
            unobservable: (nv,) dofs that move no marker of the capture; they are not predicted.
            settings: Regression and its errors.
        """
        self._model, self._ridge = model, settings.coordination_ridge_rad
        joints = [joint for joint in model.joints.values() if joint.kind != "free"]
        dofs = {joint.segment: np.arange(joint.v.start, joint.v.stop) for joint in joints}
        self._leading = np.concatenate([dofs[segment] for segment in model.roles.leading])
        self.dependents = [
            own
            for name, own in dofs.items()
            if name not in model.roles.leading and not unobservable[own].all()
        ]
        self._targets = [np.r_[own, model.nv + own] for own in self.dependents]
        self._root = next(joint for joint in model.joints.values() if joint.kind == "free")
        self._neutral, self._posture = model.neutral(), PostureSensor(model)
        self._every = max(1, round(1.0 / (NOTED_HZ * dt_s)))
        noted_s = self._every * dt_s
        self._block = max(1, round(BLOCK_S / noted_s))
        self._keep = max(1, round(settings.coordination_memory_s / noted_s))
        self._first = np.array([own[0] for own in self.dependents], dtype=np.intp)
        # A reading with a lasting error counts once in its correlation time, not in every frame.
        self._repeat = max(1.0, settings.coordination_errs_s / dt_s) ** 0.5

    def begin(self) -> CoordinationMemory:
        """Memory without noted frames."""
        return CoordinationMemory(0, (), (), {})

    def prepare(self, state: State, memory: CoordinationMemory | None) -> Mapping[int, Followed]:
        """Relations of the joints that were out of sight in the frame before, by their number.

        They are learned once, when a joint goes out of sight, if it was observed long enough.
        """
        if memory is None or not memory.gone:
            return {}
        return self._learned(memory)

    def decide(
        self,
        at: OperatingPoint[State, Mapping[int, Followed]],
        frame: Frame,
        memory: CoordinationMemory,
        notes: Notes,
    ) -> CoordinationDecision:
        """Predicted movement of the joints out of sight."""
        gone, legible = self._out_of_sight(notes)
        if not len(notes.unobserved):
            return _ALL_SEEN if legible else _LOST
        learned = {j: one for j, one in at.prepared.items() if j in gone}
        if not learned:
            return _ALL_SEEN._replace(gone=gone, legible=legible, unobserved=notes.unobserved)
        features, nv = self.features(at.state.q, at.state.v), self._model.nv
        mean, sd = np.zeros((2, 2 * nv))
        for relation in {id(one.relation): one.relation for one in learned.values()}.values():
            joints = [j for j, one in learned.items() if one.relation is relation]
            own = np.concatenate([self._targets[j] for j in joints])
            columns = np.concatenate([learned[j].columns for j in joints])
            found = relation.predicted(features)
            mean[own], sd[own] = found[0][columns], found[1][columns]
        dofs = np.flatnonzero(sd[:nv])
        notes.coordinated = dofs
        q = self._model.integrate(self._neutral, mean[:nv])
        q_sd = self._repeat * np.maximum(sd[dofs], LEAST_SD_RAD)
        v_sd = self._repeat * np.maximum(sd[nv + dofs], LEAST_SD_RAD / PACE_S)
        return CoordinationDecision(dofs, q, mean[nv + dofs], q_sd, v_sd, gone, legible, notes.unobserved)

    def linearise(
        self, at: OperatingPoint[State, Mapping[int, Followed]], decision: CoordinationDecision
    ) -> list[Rows]:
        """Whitened rows on the configuration and on the velocity."""
        dofs, state = decision.dofs, at.state
        if not len(dofs):
            return []
        away, by_q = self._posture.from_posture(decision.q, state.q)
        by_q = by_q[dofs] / decision.q_sd[:, None]
        by_v = np.zeros(by_q.shape)
        by_v[np.arange(len(dofs)), dofs] = 1.0 / decision.v_sd
        return [
            Rows(by_q, -away[dofs] / decision.q_sd),
            Rows(by_v, (decision.v - state.v[dofs]) / decision.v_sd, self.layout.v.start),
        ]

    def remember(
        self,
        posterior: State,
        at: OperatingPoint[State, Mapping[int, Followed]],
        decision: CoordinationDecision,
        memory: CoordinationMemory,
    ) -> CoordinationMemory:
        """The noted frames and the relations of joints out of sight."""
        frame, noted, gone = memory.frame + 1, memory.noted, decision.gone
        if frame % self._every == 0 and decision.legible:
            note = self._noted(frame, posterior, decision.unobserved)
            noted = (*noted[max(0, len(noted) + 1 - self._keep) :], note)
        kept = {j: one for j, one in at.prepared.items() if j in gone}
        return CoordinationMemory(frame, noted, gone, kept)

    def features(self, q: Array, v: Array) -> Array:
        """(p,) pose of trunk and legs and its rates, independent of the body's place and heading."""
        return self._features(q, v, self.posture(q))

    def _features(self, q: Array, v: Array, posture: Array) -> Array:
        """:meth:`features` with the :meth:`posture` at q."""
        up = self._model.frames(q)[4 * self._root.joint_id : 4 * self._root.joint_id + 2, 2]
        rates = np.concatenate([v[self._root.v][3:], v[self._leading]])
        return np.concatenate([up, posture[self._leading], PACE_S * rates])

    def posture(self, q: Array) -> Array:
        """(nv,) rotation of every joint from neutral."""
        return self._posture.deviation(q)[0]

    def _out_of_sight(self, notes: Notes) -> tuple[tuple[int, ...], bool]:
        """Numbers of the joints out of sight, and True if trunk and legs are observed and the track is not lost."""
        if not len(notes.unobserved):
            return (), not notes.lost
        unseen = np.zeros(self._model.nv, dtype=bool)
        unseen[notes.unobserved] = True
        legible = not notes.lost and not unseen[self._leading].any()
        return tuple(unseen[self._first].nonzero()[0].tolist()), legible

    def _learned(self, memory: CoordinationMemory) -> dict[int, Followed]:
        """Relations by number; those of joints that were observed in the same frames are learned together."""
        found = dict(memory.learned)
        fresh = np.array([j for j in memory.gone if j not in found], dtype=np.intp)
        if not len(fresh) or not memory.noted:
            return found
        observed = np.array([one.observed for one in memory.noted])[:, self._first[fresh]]
        for pattern in np.unique(observed, axis=1).T:
            there = np.flatnonzero(pattern)
            if len(there):
                alike = fresh[(observed == pattern[:, None]).all(axis=0)]
                found |= self._learned_together(alike, [memory.noted[i] for i in there])
        return found

    def _learned_together(
        self, joints: NDArray[np.intp], frames: Sequence[NotedFrame]
    ) -> dict[int, Followed]:
        columns = [self._targets[j] for j in joints]
        movements = np.array([one.movement for one in frames])[:, np.concatenate(columns)]
        features = np.array([one.features for one in frames])
        blocks = np.array([one.block for one in frames])
        learned = learn(features, movements, blocks, self._ridge)
        if learned is None:
            return {}
        places = np.split(np.arange(movements.shape[1]), np.cumsum([len(own) for own in columns[:-1]]))
        return {int(j): Followed(learned, own) for j, own in zip(joints, places, strict=True)}

    def _noted(self, frame: int, state: State, unobserved: NDArray[np.intp]) -> NotedFrame:
        observed = np.ones(self._model.nv, dtype=bool)
        observed[unobserved] = False
        posture = self.posture(state.q)
        movement = np.concatenate([posture, state.v])
        block = frame // (self._every * self._block)
        return NotedFrame(block, self._features(state.q, state.v, posture), movement, observed)
