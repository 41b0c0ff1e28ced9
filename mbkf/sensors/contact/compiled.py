"""The causal contact decision by the compiled kernel, where it was built: that of :mod:`.causal`, much faster.

Compiled code assigns plates and finds feet that stand elsewhere. The stance of two feet that share a plate, or stand
where no plate reads, is left to :mod:`.stances`.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.kernel.contact import (
    BELOW,
    KINDS,
    MOVING_OR_NEAR,
    ON_ONE_PLATE,
    ON_OPEN_FLOOR,
    STRAY,
    Stand,
)
from mbkf.kernel.tree import CompiledTree
from mbkf.model.body import Body
from mbkf.model.soles import sole_locals
from mbkf.sensors.contact.floor import fall_frames, frames_of
from mbkf.sensors.contact.records import Contact, ContactDecision, KeptContact, PackedMemory
from mbkf.sensors.contact.rules import BELT_WINDOW_S, LIMITS, STILL_FLOOR_S
from mbkf.sensors.contact.stances import free_stance, shared_between

_CONTACTS = tuple((Contact((bits & 3) - 1), Contact((bits >> 2) - 1)) for bits in range(KINDS + 1))
"""Contact of right and left foot by the bits of a decision's flags."""


class CompiledContact:
    """The decision of :class:`mbkf.sensors.contact.causal.ContactDetector` in compiled code."""

    def __init__(self, tree: CompiledTree, model: Body, plates: Array, dt_s: float) -> None:
        """Hands the constants over.

        Args:
            tree: The body's equations.
            model: The body.
            plates: (K, 23) of each plate: 1 for a known outline, least load N, height m, and its outline
                (:meth:`mbkf.sensors.contact.plates.PlateAreas.outlines`).
            dt_s: Time between frames.
        """
        segments, points_m = sole_locals(model)
        known, least_n, surfaces_m = plates[:, :3].T.copy()
        self._window = frames_of(BELT_WINDOW_S, dt_s)
        self._plates, self._surfaces_m = len(plates), surfaces_m.tolist()
        self._decide, self._feet = (
            tree.kernel.decide_contact,
            tree.kernel.make_feet(
                tree.handle,
                np.array([model.joint(segment).joint_id for segment in segments], dtype=np.int32),
                np.array([model.joint(segment).joint_id for segment in model.roles.feet], dtype=np.int32),
                model.root.joint_id,
                np.ascontiguousarray(points_m),
                self._window,
                frames_of(STILL_FLOOR_S, dt_s),
                fall_frames(dt_s),
                min(self._surfaces_m, default=np.nan),
                dt_s,
                LIMITS,
                known != 0.0,
                least_n,
                surfaces_m,
                plates[:, 3:7].copy(),
                plates[:, 7:].copy().reshape(-1, 4, 4),
            ),
        )

    @classmethod
    def where_built(cls, model: Body, plates: Array, dt_s: float) -> CompiledContact | None:
        """A compiled decision as from the constructor; None without a compiled kernel that knows the body's joints.

        Args:
            model: The body.
            plates: (K, 23) as in the constructor.
            dt_s: Time between frames.
        """
        tree = model.tree
        return None if tree is None else cls(tree, model, plates, dt_s)

    def decide(
        self,
        memory: KeptContact,
        motion: tuple[Array, Array, Array],
        plate_wrench: Array,
        supported: bool,
    ) -> ContactDecision:
        """Contact of both feet in one frame: :meth:`mbkf.sensors.contact.causal.ContactDetector.decide`.

        Args:
            memory: From the frame before.
            motion: Predicted (nq,) configuration, (nv,) velocity and acceleration.
            plate_wrench: (K, 6) force N and moment N m about the world's origin; NaN where not recorded.
            supported: True where another part than the feet carries load.
        """
        before = memory if isinstance(memory, PackedMemory) else memory.packed(self._window)
        q, v, a = (np.ascontiguousarray(one, float) for one in motion)
        wrench = np.ascontiguousarray(plate_wrench, float)
        found = self._decide(self._feet, q, v, a, wrench, supported, before.numbers)
        flags, after, measured, middles_m = found[:4]
        after.setflags(write=False)
        kept = PackedMemory(after, self._plates, self._window)
        decision = (_CONTACTS[flags & KINDS], measured, middles_m, flags & STRAY > 0, kept)
        if flags & (ON_ONE_PLATE | ON_OPEN_FLOOR | MOVING_OR_NEAR | BELOW):
            return self._completed(decision, Stand(*found), plate_wrench)
        return ContactDecision(*decision)

    def _completed(
        self,
        decision: tuple[tuple[Contact, Contact], Array, Array, bool, PackedMemory],
        stand: Stand,
        plate_wrench: Array,
    ) -> ContactDecision:
        """The decision with its further fields, which few frames have."""
        flags, kept, shared, free = stand.flags, decision[4], None, None
        if flags & (ON_ONE_PLATE | ON_OPEN_FLOOR):
            soles, pelvis_m = stand.soles_m.tolist(), stand.pelvis_m.tolist()
            if flags & ON_ONE_PLATE:
                shared = shared_between(soles, pelvis_m, plate_wrench, kept.foot_of_plate, self._surfaces_m)
            if flags & ON_OPEN_FLOOR:
                _, right_s, left_s, right_m, left_m = kept.numbers[:5].tolist()
                free = free_stance(soles, pelvis_m, (right_m, left_m), (right_s, left_s))
        near_right, near_left = stand.near.tolist()
        floor_x, floor_y = stand.floor_m_s.tolist()
        return ContactDecision(
            *decision,
            shared,
            free,
            (near_right, near_left),
            (floor_x, floor_y),
            stand.below if flags & BELOW else None,
        )
