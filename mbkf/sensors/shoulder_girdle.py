"""Shoulders that rise with the arms: displacement of the shoulder girdle on the trunk in the course of a trial.

The trunk is one segment, without clavicles and shoulder blades, and bends only at its lower end. As an arm rises by θ
from hanging, its shoulder goes upward, back and toward the middle, and takes the arm and the markers around it along.
Shoulders are also shrugged or hang, and a bent back brings them nearer to the pelvis. In a trial a shoulder is
displaced along the trunk's axes by

    h ~ N(f c, f² C + H),   f = (√(s² + s₀²) − s₀) / (√(½ + s₀²) − s₀),   s = sin(θ/2),

f averaged over the trial's frames. f is 0 with its slope for a hanging arm and goes in proportion to sin(θ/2) beyond
the first 30° of elevation, in which the shoulder blade hardly moves. The body file has c and C of a horizontal arm, and
H of a trial as a whole (:class:`mbkf.model.description.ShoulderGirdle`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.model.description import BodyDescription
from mbkf.model.sides import mirrored

SETTING = 0.14
"""s₀: of 16° of elevation."""

HORIZONTAL = float(np.sqrt(0.5 + SETTING**2) - SETTING)

WITH_SHOULDER_M, APART_M = 0.06, 0.15
"""A trunk marker nearer to the shoulder's centre than the first moves with it, one beyond the second does not; between
both in proportion."""

ALIKE = 0.85
"""Correlation of both sides of a person."""

OWN_M = 0.03
"""Spread of the displacement of a marker around the shoulder from the centre's, m. As an arm rises, the acromion goes
18 mm further to the middle and 15 mm less upward than the centre below it."""


class ShoulderGirdle:
    """The markers that move with G shoulders, and how far arms are raised.

    Attributes:
        trunk_ids: (G,) Pinocchio joint of the segment before each shoulder.
        below: (J, G) 1 for the joints that move with the shoulder.
        on_trunk: (M, G) share of a shoulder's displacement in each marker on the trunk.
        carried: (M, G) the same of all markers: 1 on the arm.
    """

    def __init__(self, model: Body, segments: Sequence[str], reference_m: Array) -> None:
        """Finds them.

        Args:
            model: A body of the description.
            segments: Segment of each of the M markers.
            reference_m: (M, 3) their places on the reference body, in the segments' frames, m.
        """
        body = model.description
        joints = [model.joint(one.segment) for one in body.girdle]
        self.trunk_ids = np.array([model.joint(name).joint_id for name in _trunks(body)], dtype=np.intp)
        self._quaternions = np.array([joint.q.start for joint in joints], dtype=np.intp)
        dofs = np.array([joint.v.start for joint in joints], dtype=np.intp)
        self.below = model.supports[:, dofs].astype(np.float64)
        self.on_trunk = around_shoulders(body, segments, reference_m)
        ids = np.array([model.joint(name).joint_id for name in segments], dtype=np.intp)
        self.carried = self.below[ids] + self.on_trunk

    def raised(self, poses: Array) -> Array:
        """(…, G) f at configurations (…, nq)."""
        squared = poses[..., self._quaternions] ** 2 + poses[..., self._quaternions + 1] ** 2
        return np.asarray((np.sqrt(squared + SETTING**2) - SETTING) / HORIZONTAL)


def around_shoulders(body: BodyDescription, segments: Sequence[str], reference_m: Array) -> Array:
    """(M, G) share of a shoulder's displacement in each marker on the trunk, 0 on other segments.

    Args:
        body: The reference body.
        segments: Segment of each of the M markers.
        reference_m: (M, 3) their places on the reference body, in the segments' frames, m.
    """
    shares = np.zeros((len(segments), len(body.girdle)))
    for g, (one, trunk) in enumerate(zip(body.girdle, _trunks(body), strict=True)):
        away = np.linalg.norm(reference_m - body.segment(one.segment).origin_m, axis=1)
        near = np.clip((APART_M - away) / (APART_M - WITH_SHOULDER_M), 0.0, 1.0)
        shares[:, g] = np.where(np.array(segments) == trunk, near, 0.0)
    return shares


def _trunks(body: BodyDescription) -> list[str]:
    """(G,) segment before each shoulder."""
    return [str(body.segment(one.segment).parent) for one in body.girdle]


def shoulder_names(body: BodyDescription) -> tuple[str, ...]:
    """(3 G,) names of the shoulders' displacements: those of the joints' centres."""
    return tuple(f"{one.segment}_centre_{axis}" for one in body.girdle for axis in "xyz")


def girdle_prior(body: BodyDescription, raised: Array) -> tuple[Array, Array]:
    """Expected displacements h of G shoulders in T trials (3 T G,), m, and their covariance (3 T G, 3 T G).

    Trials have c in common, and sides are alike.

    Args:
        body: The reference body.
        raised: (T, G) f of the trials.
    """
    girdle, trials = body.girdle, len(raised)
    mean, sd, held = (
        np.array([getattr(one, key) for one in girdle]).reshape(-1, 3) for key in ("mean_m", "sd_m", "held_m")
    )
    alike = np.zeros((len(girdle), len(girdle), 3))
    for g, one in enumerate(girdle):
        alike[g, g] = 1.0
        for h, other in enumerate(girdle):
            if g != h and other.segment == mirrored(one.segment):
                alike[g, h] = ALIKE * np.array([1.0, -1.0, 1.0])
    risen = raised[:, :, None] * sd
    across = np.einsum("ghi,tgi,uhi->tguhi", alike, risen, risen)
    across += np.einsum("ghi,gi,hi,tu->tguhi", alike, held, held, np.eye(trials))
    size = 3 * len(girdle) * trials
    covariance = np.einsum("tguhi,ij->tgiuhj", across, np.eye(3)).reshape(size, size)
    return (raised[:, :, None] * mean).ravel(), covariance
