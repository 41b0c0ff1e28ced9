"""Which frames count: every load measured, or estimated so well that the torques it changes are known.

A load that is estimated, or shared by where the feet stand, changes the torques of the joints between the part that
bears it and the root (τ = ID − Σ Jᵀ w, and J has columns for those joints alone). A frame counts as long as the
standard deviations of their flexion torques stay below a bound per body mass; a measured load is not asked. Torques
grow with the load: for a foot that strikes harder than in walking, the bound grows as the largest force of its contact.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.io.contacts import Source
from mbkf.model.body import Body
from mbkf.numerics.runs import runs

TORQUE_SD_NM_PER_KG = 0.3
"""Standard deviation of a flexion torque, per body mass, up to which an estimated load counts, N m/kg.

A fifth of the ankle's and a third of hip's and knee's peak in walking (Winter 2009). With every load measured the worst
joint of the legs has 0.06 in squats and 0.17 in walking (dynamic filter), with one plate under both feet 0.26. With a
foot that nothing reads it depends on the movement: frames in which the load changes quickly do not count."""

WALKING_SHARE = 1.2
"""Largest vertical force on a foot in walking, in body weights (Winter 2009), for which that bound is stated. Running
reaches 2 to 3, with torques of hip, knee and ankle in proportion."""

MOST_NM_PER_KG = 30.0
"""No joint of a person bears a larger torque, per body mass, N m/kg: three times the largest of landings and throws."""


def torques_possible(tau: Array, root_dofs: int, mass_kg: float) -> BoolArray:
    """(T,) frames in which every joint's torque is within the strength of people.

    Args:
        tau: (T, nv) generalised forces; the root's are left out.
        root_dofs: How many of them are the root's, the first ones.
        mass_kg: Body mass.
    """
    return np.asarray(~(np.abs(tau[:, root_dofs:]) > MOST_NM_PER_KG * mass_kg).any(axis=1))


def torques_known(
    model: Body,
    names: tuple[str, ...],
    moments_sd: Array,
    foot_source: Array,
    foot_force_n: Array,
    bears: BoolArray,
) -> BoolArray:
    """(T,) whether every estimated load leaves the torques it changes known.

    Args:
        model: The body.
        names: (A,) clinical coordinates.
        moments_sd: (T, A) standard deviations of the moments conjugate to them, N m; NaN where not known.
        foot_source: (T, 2) :class:`~mbkf.io.contacts.Source` of the feet's loads.
        foot_force_n: (T, 2) vertical force on them; NaN where not known.
        bears: (T, B) whether the parts ``description.bearings`` bear load; all of it is estimated. B is 0 where the
            filter does not ask.
    """
    flexion = {one.distal: names.index(one.main) for one in model.description.clinical_joints}
    parts = [part.segment for part in model.description.bearings.values()][: bears.shape[1]]
    estimated = np.hstack([foot_source >= Source.SHARED, bears])
    most = np.full(estimated.shape, TORQUE_SD_NM_PER_KG * model.mass_kg)
    most[:, :2] *= _growth(estimated[:, :2], foot_force_n / (GRAVITY_M_S2 * model.mass_kg))
    known = np.ones(len(estimated), dtype=bool)
    for segment, at_all, bound in zip((*model.roles.feet, *parts), estimated.T, most.T, strict=True):
        columns = [flexion[joint] for joint in joints_to_root(model, segment)]
        known &= ~at_all | (moments_sd[:, columns] <= bound[:, None]).all(axis=1)
    return known


def _growth(estimated: BoolArray, force: Array) -> Array:
    """(T, 2) factor of the bound: the largest force of each estimated contact over that of walking, at least 1.

    Args:
        estimated: (T, 2) frames in which a foot's load is estimated.
        force: (T, 2) its vertical force in body weights.
    """
    growth = np.ones(force.shape)
    for foot in range(force.shape[1]):
        for first, after in runs(estimated[:, foot]):
            largest = np.nan_to_num(force[first:after, foot]).max()
            growth[first:after, foot] = max(largest / WALKING_SHARE, 1.0)
    return growth


def joints_to_root(model: Body, segment: str) -> list[str]:
    """Segments from the given one towards the root, without the root: a load on it changes their joints' torques."""
    parents = {one.name: one.parent for one in model.description.segments}
    found = []
    while segment != model.roles.root:
        found.append(segment)
        segment = parents[segment]
    return found
