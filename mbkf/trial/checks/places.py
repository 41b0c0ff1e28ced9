"""Markers of the legs against their places in the subject file: how far a trial's correction moved them.

A marker sits a little elsewhere in every session. If most markers of a leg do, by several times the usual spread, the
subject file was scaled from exchanged names, or belongs to another person. The trunk and the pelvis are not judged:
raised arms and deep flexion move their markers as far.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mbkf.io.findings import Finding, judged, not_judged
from mbkf.io.subject import Subject
from mbkf.model.description import BodyDescription
from mbkf.model.human import reference_body

NAME = "markers at the subject's places"

BOUND, USUAL = 1.3, 0.5
"""Median displacement in units of its usual spread: the bound, and the spread of right trials (at most 1.0). Another
child has 1.4 and 1.7, names exchanged in the standing trial 5 and 11."""

LEAST_MARKERS = 3
"""A leg is judged from so many markers on."""


def place_of_markers_finding(before: Subject, after: Subject, names: Sequence[str]) -> Finding:
    """The median displacement of a leg's markers over their spread between sessions; of the leg with the larger one.

    Args:
        before: The person as the subject file has them.
        after: The same with markers corrected on the trial.
        names: Markers of the trial.
    """
    body = reference_body(before)
    side_of = sides(body)
    old = {marker.name: marker for marker in before.markers}
    found: dict[str, list[float]] = {"right": [], "left": []}
    for marker in after.markers:
        if marker.name in names and marker.segment in side_of:
            away_m = float(np.linalg.norm(marker.neutral_m - old[marker.name].neutral_m))
            found[side_of[marker.segment]].append(away_m / old[marker.name].session_sd_m)
    medians = {side: float(np.median(each)) for side, each in found.items() if len(each) >= LEAST_MARKERS}
    if not medians:
        return not_judged(NAME, "times", BOUND, "needs three markers of a leg")
    side = max(medians, key=lambda one: medians[one])
    hint = (
        f"half of the {side} leg's markers sit further from their places than that, over their usual spread"
    )
    remedy = ": check names in the standing trial, and that the subject file belongs to this person"
    finding = judged(NAME, medians[side], USUAL, "times", BOUND, hint, remedy)
    thigh = next(name for name in body.roles.legs if side_of[name] == side)
    return replace(finding, segment=thigh)


def sides(body: BodyDescription) -> dict[str, str]:
    """The side of each segment of the legs, feet and toes, by the foot that it bears or hangs on."""
    found = dict(zip(body.roles.feet, ("right", "left"), strict=True))
    for one in reversed(body.segments):  # a leg has the side of the foot that it bears
        if one.name in found and one.parent in body.roles.legs:
            found[one.parent] = found[one.name]
    toes = (one for one in body.segments if one.name in body.roles.toes)
    return found | {one.name: found[one.parent] for one in toes}
