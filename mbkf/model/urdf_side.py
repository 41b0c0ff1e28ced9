"""The side file of an exported URDF file: a body's entries besides segments, joints and inertias, scaled to the person.

All scale factors of the body that both files make are 1 for this person.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, fields

import numpy as np

from mbkf.conventions import Array, TomlTable
from mbkf.io.toml import toml_text
from mbkf.io.written import MARK
from mbkf.model.body import Body
from mbkf.model.body_shapes import segment_shapes
from mbkf.model.clinical_table import Angle, ClinicalJoint
from mbkf.model.description import Segment, Sole

_MM = 1e3


def urdf_side_text(model: Body, height_m: float) -> str:
    """The text of the side file.

    Args:
        model: The scaled body.
        height_m: The person's height.
    """
    body = model.description
    table = {
        "name": f"{body.name} (scaled)",
        "reference_height_m": height_m,
        "scale_factors": list(body.scale_factors),
        "split_factors": dict(body.split_factors),
        "roles": _roles(model),
        "sole": _sole(model, body.roles.soles[0]),
        "left_sole": _sole(model, body.roles.soles[1]),
        "segment": [_segment(one, body.scale_factors) for one in body.segments],
        "landmark": [
            {
                "name": one.name,
                "segment": one.segment,
                "position_m": _axes(model, one.segment) * one.position_m,
                "mirror": False,
            }
            for one in body.landmarks.values()
        ],
        "clinical_joint": [_clinical(model, one) for one in body.clinical_joints],
        "shape": [*_shapes(model)],
        **_loads(model),
        **_spreads(model),
    }
    kept = {key: value for key, value in table.items() if not isinstance(value, list | dict) or value}
    return toml_text(f"Side file of a URDF file, {MARK}: docs, Your own body, URDF", kept)


def _axes(model: Body, segment: str) -> Array:
    return model.axis_scale(model.description.segment(segment))


def _mass_factor(model: Body, segment: Segment) -> float:
    return float(model.pin_model.inertias[model.joint(segment.name).joint_id].mass / segment.mass_kg)


def _roles(model: Body) -> TomlTable:
    roles = asdict(model.description.roles)
    del roles["soles"], roles["legs"]
    return roles


def _sole(model: Body, sole: Sole) -> dict[str, float]:
    by = dict(zip("xyz", _axes(model, sole.segment), strict=True))
    named = (one.name for one in fields(sole) if one.name != "segment")
    axis = {"height_m": "z", "inner_y_m": "y", "outer_y_m": "y"}
    return {name: float(by[axis.get(name, "x")] * getattr(sole, name)) for name in named}


def _segment(segment: Segment, factors: tuple[str, ...]) -> TomlTable:
    return {
        "name": segment.name,
        "scale": [_factor(row, factors) for row in segment.scale_matrix],
        "length_factor": factors[segment.length_index],
        "posture_sd_deg": np.rad2deg(segment.posture_sd_rad),
        "acceleration_sd": segment.acceleration_sd,
        "movement_sd": segment.movement_sd,
        "limits_deg": np.rad2deg(segment.limits_rad),
    }


def _factor(row: Array, factors: tuple[str, ...]) -> str:
    """The factor of an axis; of several ones their mean, which the file calls so."""
    named = np.flatnonzero(row)
    return factors[int(named[0])] if len(named) == 1 else "mean"


def _clinical(model: Body, joint: ClinicalJoint) -> TomlTable:
    origin = joint.opensim_origin_m
    return {
        "name": joint.name,
        "proximal": joint.proximal,
        "distal": joint.distal,
        "order": joint.order,
        "main": joint.main,
        "heading_sd_deg": joint.heading_sd_deg,
        "opensim_origin_m": None if origin is None else _axes(model, joint.distal) * origin,
        "angle": [_angle(one) for one in joint.angles],
        **({"translation": [_angle(one) for one in joint.translations]} if joint.translations else {}),
    }


def _angle(angle: Angle) -> TomlTable:
    plain = Angle(angle.name, angle.axis, angle.sign)
    needed = ("name", "axis", "sign")
    return {key: one for key, one in asdict(angle).items() if key in needed or one != getattr(plain, key)}


def _shapes(model: Body) -> Iterable[TomlTable]:
    drawn = segment_shapes(model)
    for name, shape in model.description.shapes.items():
        one = {"segment": name, "kind": shape.kind}
        (scaled,) = drawn[name]
        if shape.kind == "limb":
            yield {**one, "to": shape.to, "numbers": scaled.numbers[6:]}
        elif shape.kind == "ellipsoid":
            side = -1.0 if name.startswith("left_") else 1.0
            yield {**one, "numbers": scaled.numbers * [1.0, side, 1.0, 1.0, 1.0, 1.0]}
        else:
            yield {**one, "numbers": scaled.numbers} if shape.kind == "tube" else one


def _loads(model: Body) -> TomlTable:
    """Parts that may bear load, and levels of the spine."""
    body = model.description
    root = body.segments[0]
    size, k, k_m = _axes(model, root.name), model.scale[root.length_index], _mass_factor(model, root)
    bearings = [
        {
            "name": one.name,
            "segment": one.segment,
            "position_m": _axes(model, one.segment) * one.position_m,
            "radius_m": one.radius_m * float(_axes(model, one.segment).mean()),
            "lever_m": one.lever_m * float(_axes(model, one.segment).mean()),
        }
        for one in body.bearings.values()
    ]
    levels = [
        {
            "name": one.name,
            "above": one.above,
            "position_m": None if one.position_m is None else size * one.position_m,
            "sd_mm": _MM * one.sd_m,
            "part_mass_kg": k_m * one.part_mass_kg,
            "part_com_m": size * one.part_com_m,
            "part_inertia_kg_m2": k_m * k**2 * one.part_inertia_kg_m2,
            "opensim": one.opensim,
        }
        for one in body.levels
    ]
    return {"bearing": bearings, "level": levels}


def _spreads(model: Body) -> TomlTable:
    """How persons differ from the body: joint centres, skin and shoulders."""
    body = model.description
    return {
        "joint_centre": [{"segment": one.segment, "sd_mm": _MM * one.sd_m} for one in body.joint_centres],
        "skin": [
            {
                "segment": one.segment,
                "flexions": one.flexions,
                "common_mm": _MM * one.common_m,
                "own_mm": _MM * one.own_m,
            }
            for one in body.skin.values()
        ],
        "girdle": [
            {
                "segment": one.segment,
                "mean_mm": _MM * one.mean_m,
                "sd_mm": _MM * one.sd_m,
                "held_mm": _MM * one.held_m,
            }
            for one in body.girdle
        ],
    }
