"""Names of the entries of a body's file."""

from __future__ import annotations

# Departs from thesis Table 4.2 in five numbers of models/human18.toml, which keeps the printed ones beside them.
REMARKS = ("source", "_printed_m", "_printed_kg_m2", "_correction")
"""Endings of keys that document the source of numbers."""

SEGMENT_KEYS = (
    "name", "parent", "joint", "axes", "origin_m", "mass_kg", "com_m", "inertia_kg_m2", "scale", "length_factor",
    "posture_sd_deg", "acceleration_sd", "movement_sd", "limits_deg",
    "products_kg_m2", "axis",
)  # fmt: skip
OPTIONAL = ("axes", "limits_deg", "products_kg_m2", "axis")
"""Entries of a segment that may be left out."""

ANGLE_KEYS = ("name", "axis", "sign", "positive", "opensim", "title", "zero_sd_deg", "opensim_zero_deg")
SOLE_KEYS = ("height_m", "heel_x_m", "ball_x_m", "toe_x_m", "inner_y_m", "outer_y_m")
KNOWN = {
    "": (
        "name", "reference_mass_kg", "reference_height_m", "scale_factors", "split_factors", "roles", "segment",
        "landmark", "sole", "clinical_joint", "shape", "bearing", "joint_centre", "skin", "level",
        "girdle", "left_sole", "approximation",
    ),
    "segment": SEGMENT_KEYS,
    "roles": ("root", "feet", "toes", "leading", "steady", "knees"),
    "landmark": ("name", "segment", "position_m", "mirror"),
    "sole": SOLE_KEYS,
    "left_sole": SOLE_KEYS,
    "clinical_joint": (
        "name", "proximal", "distal", "order", "main", "mirror", "heading_sd_deg", "angle", "translation",
        "opensim_origin_m",
    ),
    "clinical_joint.angle": ANGLE_KEYS,
    "clinical_joint.translation": ANGLE_KEYS,
    "shape": ("segment", "kind", "numbers", "to"),
    "bearing": ("name", "segment", "position_m", "radius_m", "lever_m"),
    "joint_centre": ("segment", "sd_mm"),
    "skin": ("segment", "flexions", "common_mm", "own_mm"),
    "level": (
        "name", "above", "position_m", "sd_mm", "part_mass_kg", "part_com_m", "part_inertia_kg_m2", "opensim",
    ),
    "approximation": ("segment", "rms_mm", "text"),
    "girdle": ("segment", "mean_mm", "sd_mm", "held_mm"),
}  # fmt: skip
"""Entries of a body's file."""
