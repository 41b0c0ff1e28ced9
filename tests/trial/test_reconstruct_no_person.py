"""Plates that contradict the motion past the checks of their readings: what is told is a person, or nothing."""

import warnings
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mbkf.synthesis.capture import CaptureSettings
from mbkf.trial.preparation import inputs
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.results.summary import summarise
from mbkf.trial.results.validity import MOST_NM_PER_KG
from mbkf.trial.synth import synthesise

pytestmark = pytest.mark.slow

KINDS = {
    "forces x 30, moments x 100": lambda force, moment, rng: (30.0 * force, 100.0 * moment),
    "both x 20": lambda force, moment, rng: (20.0 * force, 20.0 * moment),
    "moments in N mm": lambda force, moment, rng: (force, 1e3 * moment),
    "moments of 1e4 N m at random": lambda force, moment, rng: (force, rng.normal(0.0, 1e4, moment.shape)),
}


@cache
def walk():
    settings = CaptureSettings(occlusion=0.0, offset_n=(0.0, 0.0))
    return synthesise("walk", seconds=1.2, seed=4, settings=settings)


def spoilt(kind):
    made, rng = walk()[1].trial, np.random.default_rng(1)
    plates = []
    for plate in made.plates:
        force, moment = KINDS[kind](plate.force_n, plate.moment_nm, rng)
        plates.append(replace(plate, force_n=force, moment_nm=moment))
    return replace(made, plates=tuple(plates))


SMOOTHED = {"smooth": True}
REFUSED = "forces x 30, moments x 100"
"""Plates of which some frames cannot be smoothed."""

ASKED = [
    *((kind, SMOOTHED) for kind in KINDS),
    ("both x 20", {"smooth": False}),
    (REFUSED, {"lag_s": 0.1}),
]
"""A smoothed answer begins with the causal one."""


@pytest.mark.parametrize(("kind", "asked"), ASKED, ids=str)
def test_what_is_told_is_a_person_or_nothing(kind, asked, monkeypatch):
    monkeypatch.setattr(inputs, "cleaned", lambda plates, mass_kg: (tuple(plates), ()))
    person = walk()[0]
    settings = ReconstructSettings(checks=False, correct_markers=False, other_contacts=False, **asked)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = reconstruct(spoilt(kind), person, settings=settings)
    known = np.isfinite(found.q).all(axis=1)
    off = np.linalg.norm(found.predicted_m - found.measured_m, axis=2)
    assert np.nanmedian(off[known]) < 0.05 and np.nanmax(off[known]) < 2.0
    assert not (found.tracked & ~known).any() and not (found.valid & ~found.tracked).any()
    assert np.nanmax(np.abs(found.tau[found.valid][:, 6:]), initial=0.0) <= MOST_NM_PER_KG * person.mass_kg
    told = summarise(found)
    assert found.uncorrected or (kind, asked) != (REFUSED, SMOOTHED)
    if found.uncorrected:
        assert "causal" in told["later_frames"]
        assert any(
            f"smoothing failed in {found.uncorrected} of {found.frames} frames" in line
            for line in told["warnings"]
        )
    assert (~known).any() == any("the estimate was implausible" in line for line in told["warnings"])
