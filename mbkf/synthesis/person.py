"""Random but plausible people: scale factors, mass, and where the markers really sit on them."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import read_only
from mbkf.errors import InvalidInput
from mbkf.io.subject import Subject, SubjectMarker
from mbkf.model.body_file import load_body
from mbkf.model.human import HumanModel
from mbkf.model.protocol import load_protocol
from mbkf.synthesis import anatomy

STATURE_RANGE = (0.92, 1.05)
"""Common factor against the reference body: people of 1.66 to 1.89 m."""

SPREAD, LIMIT = 0.03, 0.08
"""Each factor's own deviation from the common one (1 sd, and at most)."""

BODY_MASS_INDEX = (21.0, 27.0)

PLACEMENT_SD_M = {"anatomical": 0.004, "technical": 0.015, "keypoint": 0.004}
"""Spread of markers about their places in the protocol, per coordinate."""

SESSION_SD_M = 0.0005
"""The markers stay in place from trial to trial; only the skin moves."""


def synthesise_subject(
    seed: int = 0,
    protocol: str = "reference36",
    body: str = "human18",
    *,
    height_m: float | None = None,
    mass_kg: float | None = None,
    varied: bool = False,
) -> Subject:
    """A person with exactly known factors, mass and marker positions, a different one for every seed.

    Args:
        seed: Chooses the person.
        protocol: Name of the marker protocol.
        body: Name of the body.
        height_m: Height, m; None: a random one in :data:`STATURE_RANGE`.
        mass_kg: Mass, kg; None: by a random index in :data:`BODY_MASS_INDEX`.
        varied: True for joint centres, zeros of angles, posture and movement of the skin with flexion that differ among
            people (:mod:`mbkf.synthesis.anatomy`). By default joints lie where the scale factors put them, and markers
            move on their segments only as the capture's settings say.

    Raises:
        UnknownName: The body or the protocol is unknown.
        InvalidInput: Height or mass is not positive.
    """
    for name, value in (("height_m", height_m), ("mass_kg", mass_kg)):
        if value is not None and not (np.isfinite(value) and value > 0.0):
            raise InvalidInput(f"{name} must be positive, got {value}")
    rng = np.random.default_rng([seed, 1])
    description = load_body(body)
    stature = rng.uniform(*STATURE_RANGE)
    if height_m is not None:
        stature = height_m / description.reference_height_m
    shared: dict[str, float] = {}
    factors = {}
    for name in (name for name in description.scale_factors if name not in description.split_factors):
        both = name.removeprefix("right_").removeprefix("left_")
        if both not in shared:
            shared[both] = rng.normal(0.0, SPREAD)
        own = shared[both] + rng.normal(0.0, 0.005)
        factors[name] = float(stature * (1 + np.clip(own, -LIMIT, LIMIT)))
    height = description.reference_height_m * stature
    mass = rng.uniform(*BODY_MASS_INDEX) * height**2
    if mass_kg is not None:
        mass = mass_kg
    model = HumanModel.scaled(factors, mass, body)
    markers = []
    for marker in load_protocol(protocol).markers:
        if marker.kind == "computed":
            continue
        offset = np.clip(rng.normal(size=3), -2.5, 2.5) * PLACEMENT_SD_M[marker.kind]
        position = model.axis_scale(description.segment(marker.segment)) * marker.position_m + offset
        markers.append(
            SubjectMarker(
                marker.name,
                marker.segment,
                read_only(position),
                marker.noise_m,
                SESSION_SD_M,
                correlated_m=marker.correlated_m,
                correlation_s=marker.correlation_s,
            )
        )
    person = Subject(
        body,
        float(mass),
        factors,
        tuple(markers),
        protocol,
        height_m=float(height),
        report={"synthetic": True, "seed": seed},
    )
    return anatomy.varied(person, seed) if varied else person


def body_of(subject: Subject) -> HumanModel:
    """The subject's scaled body."""
    return HumanModel.of(subject)
