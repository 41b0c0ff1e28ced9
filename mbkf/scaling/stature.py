"""A person of given mass and height: the reference body, larger or smaller as a whole."""

from __future__ import annotations

import numpy as np

from mbkf.errors import InvalidInput
from mbkf.io.subject import Subject
from mbkf.model.body_file import load_body
from mbkf.model.description import BodyDescription

HEIGHT_M, MASS_KG = (0.5, 2.5), (5.0, 400.0)
"""Ranges of a person's height and mass."""

DOUBTFUL_SHARE = 0.1
"""Difference of the stated height from that of the segments, as a share, from which one of them is another person's."""


def person_of_stature(mass_kg: float, height_m: float, body: str = "human18") -> Subject:
    """A person without markers, whose segments are those of the reference body, scaled by the height.

    Args:
        mass_kg: Body mass.
        height_m: Body height.
        body: Name of the reference body.

    Raises:
        InvalidInput: Mass or height is outside a person's range.
        UnknownName: The body does not exist.
    """
    for name, value, (low, high) in (("mass", mass_kg, MASS_KG), ("height", height_m, HEIGHT_M)):
        if not (np.isfinite(value) and low <= value <= high):
            raise InvalidInput(f"--{name} {value:g}: give a {name} between {low:g} and {high:g}")
    description = load_body(body)
    share = height_m / description.reference_height_m
    factors = dict.fromkeys(description.scale_factors, float(share))
    return Subject(body, float(mass_kg), factors, (), "", float(height_m), {"stature": True})


def stature_doubts(height_m: float | None, subject: Subject, body: BodyDescription) -> tuple[str, ...]:
    """A sentence where the stated height is not that of the segments.

    Args:
        height_m: The height that was stated; None without.
        subject: The scaled person.
        body: The reference body.
    """
    if height_m is None:
        return ()
    segments_m = float(np.median(list(subject.scale_factors.values()))) * body.reference_height_m
    if abs(segments_m / height_m - 1.0) <= DOUBTFUL_SHARE:
        return ()
    return (
        f"the height is stated as {height_m:.2f} m, the markers are those of a person of about {segments_m:.2f} m; "
        "check --height, and that the static trial is this person's",
    )
