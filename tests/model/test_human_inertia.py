"""A body with inertia of its own, against the table's."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import UnknownName
from mbkf.io.inertia import SegmentInertia
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel


def test_own_inertia_changes_its_segments_alone_and_keeps_the_whole_mass():
    """Masses are shares, moments go with them; without own inertia every number is the table's."""
    subject = Subject("human18", 75.0, {"torso_width": 1.1}, (), "reference36")
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
