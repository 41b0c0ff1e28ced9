"""A body with inertia of its own, against the table's."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput, UnknownName
from mbkf.io.inertia import SegmentInertia
from mbkf.io.subject import Subject
from mbkf.model.body_file import load_body
from mbkf.model.human import HumanModel

FACTORS = {**dict.fromkeys(load_body().scale_factors, 1.0), "torso_width": 1.1}


def test_own_inertia_changes_its_segments_alone_and_keeps_the_whole_mass():
    """Masses are shares, moments go with them; without own inertia every number is the table's."""
    subject = Subject("human18", 75.0, FACTORS, (), "reference36")
    own = {"torso": SegmentInertia(1.2, np.array([0.0, 0.01, -0.02]))}
    plain = HumanModel.scaled({"torso_width": 1.1}, 75.0).pin_model.inertias
    table = HumanModel.of(subject)
    assert all(a == b for a, b in zip(table.pin_model.inertias, plain, strict=True))
    model = HumanModel.of(replace(subject, inertia=own))
    joint = model.joint("torso").joint_id
    gain = 75.0 / (75.0 + 0.2 * plain[joint].mass)
    for j, (found, by_table) in enumerate(zip(model.pin_model.inertias, plain, strict=True)):
        factor, shift = (1.2, own["torso"].centre_shift_m) if j == joint else (1.0, np.zeros(3))
        np.testing.assert_allclose(found.mass, gain * factor * by_table.mass, rtol=1e-12)
        np.testing.assert_allclose(found.lever, by_table.lever + shift, atol=1e-15)
        np.testing.assert_allclose(found.inertia, gain * factor * by_table.inertia, rtol=1e-12, atol=1e-15)
    with pytest.raises(UnknownName, match="tail"):
        HumanModel.of(replace(subject, inertia={"tail": SegmentInertia()}))


def test_a_deleted_scale_factor_is_missed_and_not_1():
    """A subject lists every factor of its body; one without any is the reference body."""
    lacking = {name: value for name, value in FACTORS.items() if name != "right_thigh"}
    subject = Subject("human18", 75.0, lacking, (), "reference36")
    with pytest.raises(InvalidInput, match="lacks the scale factor right_thigh of the body 'human18'"):
        HumanModel.of(subject)
    with pytest.raises(UnknownName, match="unknown scale factor 'right_thig'; did you mean right_thigh"):
        HumanModel.of(replace(subject, scale_factors={**FACTORS, "right_thig": 1.0}))
    assert (HumanModel.of(replace(subject, scale_factors={})).scale == 1.0).all()


def test_a_standing_posture_of_another_body_is_refused():
    subject = Subject("human18", 75.0, FACTORS, (), "reference36")
    posture = HumanModel.of(subject).neutral()
    assert HumanModel.of(replace(subject, report={"standing_q": posture})).nq == len(posture)
    with pytest.raises(InvalidInput, match="holds 66 numbers instead of the 67 of the body 'human18'"):
        HumanModel.of(replace(subject, report={"standing_q": posture[1:]}))
