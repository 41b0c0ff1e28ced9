"""The reference body with hinges that turn about oblique axes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mbkf.conventions import read_only
from mbkf.model.body_file import load_body
from mbkf.model.description import BodyDescription

AXES = {"right_toes": (0.2, 0.95, -0.15), "left_toes": (-0.3, 0.8, 0.1)}


def oblique_body() -> BodyDescription:
    """``human18`` with toes that bend about :data:`AXES`."""
    body = load_body()
    axes = {name: read_only(np.array(one) / np.linalg.norm(one)) for name, one in AXES.items()}
    segments = tuple(replace(one, axis=axes.get(one.name)) for one in body.segments)
    joints = tuple(one.about(axes[one.distal]) if one.distal in axes else one for one in body.clinical_joints)
    return replace(body, segments=segments, clinical_joints=joints)
