"""Persons of our own body are judged by the same names: an exact result has no error, a turned one its turn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchmarks.foreign.errors import GROUPS
from benchmarks.foreign.own_body import against
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.synth import synthesise


def test_errors_are_those_of_the_truth() -> None:
    person, made = synthesise("walk", seed=1, seconds=1.0)
    found = reconstruct(made.trial, person, settings=ReconstructSettings(smooth=False, checks=False))
    names = ClinicalAngles(HumanModel.of(person)).names
    exact = ClinicalAngles(HumanModel.of(found.subject)).angles(made.truth.q)
    turned = exact.copy()
    turned[:, names.index("knee_angle_r")] += 0.1
    judged = against("p", "walk", replace(found, angles=turned), made.truth, person)
    errors = {one.name: one.error[found.tracked] for one in judged.angles}
    assert set(errors) == {name for held in GROUPS.values() for name in held}
    np.testing.assert_allclose(errors.pop("knee_angle_r"), np.degrees(0.1))
    for error in errors.values():
        np.testing.assert_allclose(error, 0.0, atol=1e-9)
