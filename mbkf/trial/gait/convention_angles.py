"""The angles of a result in a convention, with their spreads: the one place where coordinates become its curves.

Two readings of a joint are functions of one rotation R. With δ its error, dθ = E δ in the axes of the result and
dθ' = E' δ in the convention's (:meth:`mbkf.model.clinical.ClinicalAngles.ball_rates`), so that dθ' = E' E⁻¹ dθ:
variances are those of independent errors of a joint's angles. Feet and trunk in the direction of progression follow
from all joints between them and the world, whose errors count as independent; markers on a foot tie these together, so
that its spread is an upper estimate.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.results import Reconstruction
from mbkf.model.angle_reading import AngleReading
from mbkf.model.body import Body
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.numerics.cardan import cardan_angles, quaternion_matrices, rate_map
from mbkf.trial.gait.convention import FOOT_PROGRESSION, TRUNK, Convention
from mbkf.trial.results.clinical import joint_angles
from mbkf.trial.results.progression import LABORATORY, progression_of
from mbkf.trial.results.readings import STATIC, angle_reading, zero_posture

SPREADS = ("angles_sd", "angles_sd_offset", "angles_sd_change")
"""Arrays of a result that are carried into the convention's axes."""

ORDER, PARITY = np.array([1, 0, 2]), np.array(-1.0)
"""Order of the angles of pelvis, feet and trunk, about the axes to the left, forward and up, and its parity."""


@dataclass(frozen=True)
class ConventionAngles:
    """Angles in a convention's axes and signs; those of the midline as the right side sees them.

    Attributes:
        names: (N,) the body's coordinates, and the convention's own curves.
        axes: Axes that they are read in: "model", "isb" or "pig"; the result's where the body lacks a landmark that the
            convention's axes are made of.
        values: (T, N) rad, m for translations.
        spreads: (3, T, N) standard deviations: total, offset, change.
    """

    names: tuple[str, ...]
    axes: str
    values: Array
    spreads: Array

    def of(self, name: str) -> tuple[Array, Array]:
        """(T,) values and (3, T) spreads of a curve."""
        at = self.names.index(name)
        return self.values[:, at], self.spreads[:, :, at]


def convention_angles(r: Reconstruction, convention: Convention) -> ConventionAngles:
    """The angles of a result.

    Args:
        r: The result.
        convention: The convention.
    """
    names, values = r.coordinate_names, np.array(r.angles)
    spreads = np.array([getattr(r, name) for name in SPREADS])
    axes = r.angles_read
    if convention.axes:
        model = HumanModel.of(r.subject)
        reading = _reading(r, model, convention.axes)
        heading_rad = _heading(r, model)
        if reading.name != r.angles_read:
            values, spreads = _read_again(r, model, reading, heading_rad, spreads)
            axes = reading.name
        if convention.walking:
            own = _in_progression(r, model, reading, heading_rad)
            names = (*names, *own)
            values = np.column_stack([values, *(one for one, _ in own.values())])
            spreads = np.concatenate([spreads, *(sd[:, :, None] for _, sd in own.values())], axis=2)
    signs = np.array([convention.angle_sign(name) for name in names])
    return ConventionAngles(names, axes, signs * values, spreads)


def _reading(r: Reconstruction, model: Body, asked: str) -> AngleReading:
    """The axes that are asked for, or the result's where the body lacks a landmark that they are made of."""
    try:
        return angle_reading(asked, model, r.subject, r.processing)
    except InvalidInput:
        return angle_reading(r.angles_read, model, r.subject, r.processing)


def _heading(r: Reconstruction, model: Body) -> Array:
    """(T,) heading of the frame of progression, also where the result's angles of the root are the laboratory's."""
    if r.direction == LABORATORY or r.heading_rad is None:
        return progression_of(model, r.q, r.times_s).heading_rad
    return r.heading_rad


def _read_again(
    r: Reconstruction, model: Body, reading: AngleReading, heading_rad: Array, spreads: Array
) -> tuple[Array, Array]:
    """(T, A) angles and (3, T, A) spreads in other axes."""
    old = ClinicalAngles(model, angle_reading(r.angles_read, model, r.subject, r.processing))
    new = ClinicalAngles(model, reading)
    known = np.asarray(np.isfinite(r.q).all(axis=1))
    carried, q = spreads.copy(), new.against(heading_rad, r.q)
    values = new.angles(q)
    before = old.angles(r.q if r.heading_rad is None else old.against(r.heading_rad, r.q))[known]
    turns = np.linalg.inv(old.ball_rates(r.q[known], before))
    J = new.ball_rates(q[known], values[known]) @ turns
    balls = [joint.name for joint in new.joints if len(joint.order) == 3]
    for n in (balls.index(name) for name in reading.joints if name in balls):
        variances = np.einsum("tij,stj->sti", J[:, n] ** 2, spreads[:, known][:, :, old.ball_columns[n]] ** 2)
        carried[np.ix_(np.arange(len(SPREADS)), np.flatnonzero(known), new.ball_columns[n])] = np.sqrt(
            variances
        )
    if r.angles_zero == STATIC:
        zero_q = zero_posture(STATIC, r.subject)
        assert zero_q is not None
        values = values - joint_angles(new, zero_q)
    return values, carried


def _in_progression(
    r: Reconstruction, model: Body, reading: AngleReading, heading_rad: Array
) -> dict[str, tuple[Array, Array]]:
    """(T,) angles and (3, T) spreads of feet and trunk in the direction of progression, by name."""
    found = {}
    change = np.full(r.frames, np.nan)
    variances = [sd**2 for sd in (r.sd_q, r.sd_q_offset)]
    for k, (side, foot) in enumerate(zip("rl", model.roles.feet, strict=True)):
        axes = reading.joints.get(f"ankle_{side}")
        chain = _chain(model, foot)
        if axes is None or chain is None:
            continue
        turns = _world_turns(model, chain, r.q)
        R = turns[-2] @ axes.proximal @ axes.rotations(_joint_turn(model, foot, r.q))
        angles, rates = _from_ahead(R, heading_rad)
        inward = 1.0 if k == 0 else -1.0
        sds = [_spread(model, chain, turns, rates[:, 2:], one)[:, 0] for one in variances]
        found[f"{FOOT_PROGRESSION}_{side}"] = (inward * angles[:, 2], np.array([*sds, change]))
    trunk = next((j.distal for j in model.description.clinical_joints if j.name == "lumbar"), "")
    chain = _chain(model, trunk) if trunk else None
    if chain is not None:
        turns = _world_turns(model, chain, r.q)
        R = turns[-1] if reading.trunk is None else turns[-1] @ reading.trunk
        angles, rates = _from_ahead(R, heading_rad)
        sds = [_spread(model, chain, turns, rates, one) for one in variances]
        signs = np.array([1.0, -1.0, 1.0])  # forward, the right side up, turned to the left
        for k, name in enumerate(TRUNK):
            found[name] = (signs[k] * angles[:, k], np.array([*(sd[:, k] for sd in sds), change]))
    return found


def _from_ahead(R: Array, heading_rad: Array) -> tuple[Array, Array]:
    """Attitudes against axes that look ahead: tilt, obliquity and rotation, in this order.

    Args:
        R: (T, 3, 3) orientations in the world.
        heading_rad: (T,) direction in which the axes look.

    Returns:
        (T, 3) angles about the axes to the left, forward and up, and (T, 3, 3) their rates per angular velocity about
        the world's axes.
    """
    cosine, sine = np.cos(heading_rad), np.sin(heading_rad)
    zero, one = np.zeros_like(cosine), np.ones_like(cosine)
    ahead = np.stack([cosine, sine, zero, -sine, cosine, zero, zero, zero, one], axis=-1).reshape(-1, 3, 3)
    R_ijk = (ahead @ R)[:, ORDER[:, None], ORDER[None, :]]
    angles = cardan_angles(R_ijk, PARITY)
    return angles, rate_map(angles, PARITY)[..., np.argsort(ORDER)] @ np.swapaxes(R, 1, 2)


def _chain(model: Body, segment: str) -> tuple[str, ...] | None:
    """Segments from the root to this one; None where a joint between them has no rotation by three angles."""
    found, parents = [segment], {one.name: one.parent for one in model.description.segments}
    while found[0] != model.roles.root:
        found.insert(0, parents[found[0]])
    balls = all(model.joint(one).kind in ("free", "spherical") for one in found)
    return tuple(found) if balls else None


def _joint_turn(model: Body, segment: str, q: Array) -> Array:
    """(T, 3, 3) rotation of a segment's joint."""
    end = model.joint(segment).q.stop
    return quaternion_matrices(q[:, end - 4 : end])


def _world_turns(model: Body, chain: tuple[str, ...], q: Array) -> list[Array]:
    """(T, 3, 3) orientation in the world of each segment of a chain."""
    turns = [_joint_turn(model, chain[0], q)]
    for segment in chain[1:]:
        turns.append(turns[-1] @ _joint_turn(model, segment, q))
    return turns


def _spread(model: Body, chain: tuple[str, ...], turns: list[Array], rates: Array, variance: Array) -> Array:
    """(T, K) standard deviations of K angles with these rates (T, K, 3) per angular velocity about the world's axes.

    Args:
        model: The body.
        chain: Segments from the root on.
        turns: Their orientations.
        rates: Rates of the angles.
        variance: (T, nv) variances in the tangent space, each joint's about its own segment's axes.
    """
    total = np.zeros(rates.shape[:2])
    for segment, R in zip(chain, turns, strict=True):
        end = model.joint(segment).v.stop
        total += np.einsum("tki,ti->tk", (rates @ R) ** 2, variance[:, end - 3 : end])
    return np.sqrt(total)
