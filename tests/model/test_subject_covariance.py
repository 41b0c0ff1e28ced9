"""Covariances of subjects that older versions scaled, completed by the reference body."""

from dataclasses import replace

import numpy as np

from mbkf.io.body_covariance import BodyCovariance
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel
from mbkf.model.joint_centres import centre_covariance
from mbkf.model.subject_covariance import covariance_of
from tests.motions import reference_model


def test_a_split_factor_is_its_origin_where_it_is_not_stated():
    """Subjects of before the pelvis had a vertical factor of its own keep their body, and the spread of its size."""
    body, rng = reference_model().description, np.random.default_rng(0)
    ((split, origin),) = body.split_factors.items()
    older = tuple(name for name in body.scale_factors if name != split)
    factors = dict(zip(older, rng.uniform(0.9, 1.1, len(older)), strict=True))
    known = BodyCovariance(older, (), np.tril(rng.normal(size=(len(older),) * 2)))
    subject = Subject(body.name, 70.0, factors, (), "", covariance=known)
    assert dict(zip(body.scale_factors, HumanModel.of(subject).scale, strict=True))[split] == factors[origin]
    place = [older.index(body.split_factors.get(name, name)) for name in body.scale_factors]
    found, count = covariance_of(subject, body), len(body.scale_factors)
    np.testing.assert_allclose(
        found.covariance[:count, :count], known.covariance[np.ix_(place, place)], atol=1e-12
    )
    np.testing.assert_allclose(found.covariance[count:, count:], centre_covariance(body), atol=1e-12)
    assert covariance_of(replace(subject, covariance=found), body) is found
