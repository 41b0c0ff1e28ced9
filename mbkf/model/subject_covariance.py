"""The covariance of a subject's body in the terms of its reference body, also where an older version scaled it."""

from __future__ import annotations

import numpy as np

from mbkf.io.body_covariance import BodyCovariance
from mbkf.io.subject import Subject
from mbkf.model.description import BodyDescription
from mbkf.model.joint_centres import centre_covariance, centre_names


def covariance_of(subject: Subject, body: BodyDescription) -> BodyCovariance | None:
    """The covariance that scaling left, of all of the body's factors: one that was part of another errs as that one.

    Args:
        subject: The person.
        body: Its reference body.
    """
    known = subject.covariance
    if known is None:
        return None
    if known.factors == body.scale_factors:
        return _with_centres(known, body)
    origin = [body.split_factors.get(name, name) for name in body.scale_factors]
    wanted = [
        name if name in known.factors else other
        for name, other in zip(body.scale_factors, origin, strict=True)
    ]
    if not set(wanted) <= set(known.factors):
        return known
    rows = [known.factors.index(name) for name in wanted]
    root = known.root[[*rows, *range(len(known.factors), len(known.root))]]
    split = BodyCovariance.of(body.scale_factors, known.markers, root @ root.T, known.flexions, known.centres)
    return _with_centres(split, body)


def _with_centres(known: BodyCovariance, body: BodyDescription) -> BodyCovariance:
    """A covariance that lacks joint centres with the spread of the body file; the others as they are."""
    names = centre_names(body)
    if known.centres == names:
        return known
    sizes, places = len(known.factors), len(known.factors) + len(known.centres)
    kept = np.r_[0:sizes, places : len(known.root)]
    covariance = np.insert(known.covariance[np.ix_(kept, kept)], [sizes] * len(names), 0.0, axis=0)
    covariance = np.insert(covariance, [sizes] * len(names), 0.0, axis=1)
    own = slice(sizes, sizes + len(names))
    covariance[own, own] = centre_covariance(body)
    return BodyCovariance.of(known.factors, known.markers, covariance, known.flexions, names)
