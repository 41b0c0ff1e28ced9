"""What head, arms and toes do while nothing shows them: what they did with trunk and legs when the trial showed them.

Arms swing with the legs, toes bend with the foot. Many times a second the filter notes the pose of trunk and legs and,
of every other joint in sight, posture and velocity. When a joint goes out of sight it learns from the last seconds how
these go with those (:mod:`mbkf.filters.synergy`), and reads the joint to move as that says, as exactly as it held.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.filters.dynamic_records import Decision, Expected, Memory, Shown, ShownFrame
from mbkf.filters.dynamic_settings import DynamicSettings
from mbkf.filters.singer import DynamicState
from mbkf.filters.synergy import Synergy, learn
from mbkf.model.human import HumanModel

SHOWN_HZ, BLOCK_S = 25.0, 0.5
"""How often frames are noted, and how long a block of them is that is left out at a time."""

PACE_S = 0.15
"""A velocity counts as much as the angle it covers in this time: about the inverse rate of a stride."""

LEAST_SD_RAD = 0.02
"""No joint follows more exactly than this, nor its velocity than this per PACE_S."""


class Habit:
    """A body's habits as a part of the dynamic filter.

    Attributes:
        followers: Dofs of each joint that follows.
    """

    def __init__(self, model: HumanModel, dt_s: float, held: BoolArray, settings: DynamicSettings) -> None:
        """Dofs that are ``held`` (nv,) need no habit."""
        self._model, self._ridge = model, settings.habit_ridge_rad
        joints = [joint for joint in model.joints.values() if joint.kind != "free"]
        dofs = {joint.segment: np.arange(joint.v.start, joint.v.stop) for joint in joints}
        self._leading = np.concatenate([dofs[segment] for segment in model.roles.leading])
        self.followers = [
            own for name, own in dofs.items() if name not in model.roles.leading and not held[own].all()
        ]
        self._root = next(joint for joint in model.joints.values() if joint.kind == "free")
        self._neutral = model.neutral()
        self._every = max(1, round(1.0 / (SHOWN_HZ * dt_s)))
        noted_s = self._every * dt_s
        self._block = max(1, round(BLOCK_S / noted_s))
        self._keep = max(1, round(settings.habit_memory_s / noted_s))
        self._first = np.array([own[0] for own in self.followers], dtype=np.intp)
        # A reading that errs alike for a while counts once in that time, not in every frame.
        self._repeat = max(1.0, settings.habit_errs_s / dt_s) ** 0.5

    def features(self, q: Array, v: Array) -> Array:
        """(p,) pose of trunk and legs and its rates, wherever the body is and whichever way it faces."""
        up = self._model.placements(q)[0][self._root.joint_id][2, :2]
        turn = v[self._root.v][3:]
        rates = np.concatenate([turn, v[self._leading]])
        return np.concatenate([up, self.posture(q)[self._leading], PACE_S * rates])

    def posture(self, q: Array) -> Array:
        """(nv,) rotation of every joint from neutral."""
        posture = q.copy()
        posture[self._root.q] = self._neutral[self._root.q]
        return self._model.difference(self._neutral, posture)

    def learned(self, memory: Memory) -> Mapping[int, Synergy]:
        """How the joints that were out of sight in the frame before go with the others, by their number.

        Learned once, when they go; not of those that were seen too little.
        """
        if memory.shown is None or not memory.shown.gone:
            return {}
        return self._learned(memory.shown)

    def decide(self, decision: Decision, synergies: Mapping[int, Synergy], prior: DynamicState) -> Decision:
        """The decision with what the joints out of sight are expected to do; as it was where there is no habit."""
        if not synergies:
            return decision
        gone = self._gone(decision)
        synergies = {j: synergy for j, synergy in synergies.items() if j in gone}
        if not synergies:
            return decision
        features = self.features(prior.q, prior.v)
        x, v, x_sd, v_sd = np.zeros((4, self._model.nv))
        for j, synergy in synergies.items():
            own, (mean, sd) = self.followers[j], synergy.expected(features)
            x[own], v[own] = mean[: len(own)], mean[len(own) :]
            x_sd[own] = self._repeat * np.maximum(sd[: len(own)], LEAST_SD_RAD)
            v_sd[own] = self._repeat * np.maximum(sd[len(own) :], LEAST_SD_RAD / PACE_S)
        dofs = np.flatnonzero(x_sd)
        q = self._model.integrate(self._neutral, x)
        return decision._replace(expected=Expected(dofs, q, v[dofs], x_sd[dofs], v_sd[dofs]))

    def rows(self, state: DynamicState, decision: Decision) -> list[tuple[int, Array, Array]]:
        """Whitened rows on posture and on velocity, each with its first column's place in the state, and innovations.

        Args:
            state: Where to linearise.
            decision: What the frame's readings were taken to be.
        """
        expected = decision.expected
        if expected is None:
            return []
        dofs, nv = expected.dofs, self._model.nv
        away = self._model.difference(expected.q, state.q)[dofs]
        by_q = self._model.difference_derivative(expected.q, state.q)[dofs] / expected.q_sd[:, None]
        by_v = np.eye(nv)[dofs] / expected.v_sd[:, None]
        return [
            (0, by_q, -away / expected.q_sd),
            (nv, by_v, (expected.v - state.v[dofs]) / expected.v_sd),
        ]

    def remember(
        self,
        memory: Memory,
        before: Memory,
        state: DynamicState,
        decision: Decision,
        synergies: Mapping[int, Synergy],
    ) -> Memory:
        """The memory with what this frame showed, and with what was learned of joints that are out of sight."""
        last = before.shown or Shown(0, (), (), {})
        frame, noted, gone = last.frame + 1, last.noted, self._gone(decision)
        if frame % self._every == 0 and self._legible(decision):
            noted = (*noted[max(0, len(noted) + 1 - self._keep) :], self._noted(frame, state, decision))
        kept = {j: synergy for j, synergy in synergies.items() if j in gone}
        return memory._replace(shown=Shown(frame, noted, gone, kept))

    def _gone(self, decision: Decision) -> tuple[int, ...]:
        """Numbers of the joints that are out of sight."""
        if not len(decision.unseen):
            return ()
        return tuple(np.flatnonzero(np.isin(self._first, decision.unseen)).tolist())

    def _legible(self, decision: Decision) -> bool:
        """Whether trunk and legs are where the state says."""
        if decision.strayed:
            return False
        return not len(decision.unseen) or not np.isin(self._leading, decision.unseen).any()

    def _learned(self, shown: Shown) -> dict[int, Synergy]:
        """Joints that were seen in the same frames are learned together."""
        found = dict(shown.synergies)
        fresh = np.array([j for j in shown.gone if j not in found], dtype=np.intp)
        if not len(fresh) or not shown.noted:
            return found
        seen = np.array([one.seen for one in shown.noted])[:, self._first[fresh]]
        for pattern in np.unique(seen, axis=1).T:
            there = np.flatnonzero(pattern)
            if len(there):
                alike = fresh[(seen == pattern[:, None]).all(axis=0)]
                found |= self._learned_together(alike, [shown.noted[i] for i in there])
        return found

    def _learned_together(self, joints: NDArray[np.intp], frames: Sequence[ShownFrame]) -> dict[int, Synergy]:
        columns = [np.r_[self.followers[j], self._model.nv + self.followers[j]] for j in joints]
        movements = np.array([one.movement for one in frames])[:, np.concatenate(columns)]
        features = np.array([one.features for one in frames])
        blocks = np.array([one.block for one in frames])
        learned = learn(features, movements, blocks, self._ridge)
        if learned is None:
            return {}
        ends = np.cumsum([len(own) for own in columns])
        return {
            int(j): learned.only(slice(end - len(own), end))
            for j, own, end in zip(joints, columns, ends, strict=True)
        }

    def _noted(self, frame: int, state: DynamicState, decision: Decision) -> ShownFrame:
        seen = np.ones(self._model.nv, dtype=bool)
        seen[decision.unseen] = False
        movement = np.concatenate([self.posture(state.q), state.v])
        block = frame // (self._every * self._block)
        return ShownFrame(block, self.features(state.q, state.v), movement, seen)
