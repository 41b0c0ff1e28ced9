"""Variation among people: a synthetic person as a draw from the spreads that scaling and filters count on.

These are of joint centres that lie elsewhere than scale factors put them, of the zero of some angles, of skin that
moves as joints flex (``[[joint_centre]]``, ``zero_sd_deg`` and ``[[skin]]`` of the body file), of how straight people
hold their joints, and of segment masses and centres of mass (:mod:`mbkf.model.inertia_spread`). On people who have all
of this, stated intervals can be judged; those without it suit exact comparisons.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.io.inertia import SegmentInertia
from mbkf.io.subject import Subject, SubjectMarker
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.description import BodyDescription
from mbkf.model.human import HumanModel, reference_body
from mbkf.model.inertia_spread import CENTRE_SD, MASS_SD, WHOLE_SD, inertia_precision
from mbkf.model.inertial_regressor import InertialRegressor
from mbkf.model.joint_centres import centre_covariance, centre_names
from mbkf.sensors.flexed_skin import flexions_of
from mbkf.synthesis.plan import JOINTS

STREAM = (1, 1)
"""Numbers beside the seed that choose these draws: the other ones of a person do not depend on them."""

HELD_RAD = 0.14
"""Spread of a joint's rotation in straight standing, as scaling has it; less for joints with a smaller spread in
movement (``posture_sd_deg`` of the body file)."""

MOST_SD = 2.5
"""No draw is further from its mean."""


def varied(person: Subject, seed: int) -> Subject:
    """The person with joint centres, zeros of angles, skin, posture and masses drawn from the stated spreads.

    Args:
        person: A synthetic person without them.
        seed: Chooses the draws.
    """
    rng, body = np.random.default_rng([seed, *STREAM]), reference_body(person)
    root = np.linalg.cholesky(centre_covariance(body))
    centres = dict(zip(centre_names(body), (root @ _drawn(rng, len(root))).tolist(), strict=True))
    spreads = {angle.name: angle.zero_sd_deg for joint in body.clinical_joints for angle in joint.angles}
    zeros = {name: sd * float(_drawn(rng, 1)[0]) for name, sd in spreads.items() if sd > 0.0}
    return replace(
        person,
        joint_centres_m=centres,
        angle_zeros_deg=zeros,
        markers=_on_skin(person.markers, body, rng),
        habit_deg=_habit_deg(HumanModel.of(person), rng),
        inertia=_inertia(HumanModel.of(person), rng),
    )


def _habit_deg(model: HumanModel, rng: np.random.Generator) -> dict[str, float]:
    """How joints are held, by joint and axis: those that motions prescribe, the knee without its flexion."""
    found = {}
    for name in JOINTS:
        joint = model.joint(name)
        axes = joint.axes or "xyz"
        spreads = np.rad2deg(np.minimum(model.posture_sd[joint.v], HELD_RAD))
        for axis, sd, drawn in zip(axes, spreads, _drawn(rng, len(axes)), strict=True):
            if not (name.endswith("shank") and axis == "y"):
                found[f"{name}_{axis}"] = float(sd * drawn)
    return found


def _inertia(model: HumanModel, rng: np.random.Generator) -> dict[str, SegmentInertia]:
    """Masses and centres of mass of the segments, beside the table."""
    regressor = InertialRegressor(model)
    root = np.linalg.cholesky(np.linalg.inv(inertia_precision(regressor, MASS_SD, CENTRE_SD, WHOLE_SD)))
    away = (root @ _drawn(rng, len(root))).reshape(len(regressor.names), -1)
    return {
        name: SegmentInertia(float(1.0 + own[0]), read_only(own[1:]))
        for name, own in zip(regressor.names, away, strict=True)
    }


def _on_skin(
    markers: tuple[SubjectMarker, ...], body: BodyDescription, rng: np.random.Generator
) -> tuple[SubjectMarker, ...]:
    """The markers with displacements by flexion; a keypoint, which a network places, has none of them."""
    worn = [m for m in markers if m.segment in body.skin and m.correlated_m == 0.0]
    flexions = flexions_of(body, [m.segment for m in worn])
    common = {name: skin.common_m * _drawn(rng, len(skin.flexions), 3) for name, skin in body.skin.items()}
    moved = {}
    for marker in worn:
        own = body.skin[marker.segment].own_m * _drawn(rng, *common[marker.segment].shape)
        slides = np.zeros((flexions, 3))
        slides[: len(own)] = common[marker.segment] + own
        moved[marker.name] = replace(marker, slides_m=read_only(slides), slid=read_only(np.zeros(flexions)))
    return tuple(moved.get(marker.name, marker) for marker in markers)


def _drawn(rng: np.random.Generator, *shape: int) -> Array:
    return np.clip(rng.normal(size=shape), -MOST_SD, MOST_SD)


def true_angles(person: Subject, q: Array) -> Array:
    """(T, A) clinical coordinates by the person's own bones, rad and m, at true configurations (T, nq)."""
    clinical = ClinicalAngles(HumanModel.of(person))
    zeros = [person.angle_zeros_deg.get(name, 0.0) for name in clinical.names]
    return np.asarray(clinical.angles(q) + np.deg2rad(zeros))
