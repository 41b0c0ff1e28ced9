"""The spread of hip centres follows from the covariance of the body, and a note states the remedy."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.body_covariance import BodyCovariance
from mbkf.model.human import HumanModel
from mbkf.model.joint_centres import centre_names
from mbkf.sensors.flexed_skin import flexions_of
from mbkf.trial.hip_centres import hip_note, hip_spread_m
from tests.bending import stander


def known(factor_sd=0.0, place_m=(0.0, 0.0, 0.0), slide_m=0.0, right_hip_m=0.0):
    """The standing person of whom one scale factor, or the places of all markers, are uncertain."""
    subject = stander()
    body, names = HumanModel.of(subject).description, [m.name for m in subject.markers]
    flexions = flexions_of(body, [m.segment for m in subject.markers])
    factors, centres = body.scale_factors, centre_names(body)
    count = len(factors) + len(centres)
    root = np.zeros((count + 3 * len(names) * (1 + flexions),) * 2)
    root[factors.index("pelvis_width"), 0] = factor_sd
    root[count : count + 3 * len(names), 1] = np.tile(place_m, len(names))
    root[count + 3 * len(names) :, 2] = slide_m
    root[len(factors) + centres.index("right_thigh_centre_z"), 3] = right_hip_m
    covariance = BodyCovariance(factors, tuple(names), root, flexions, centres)
    return replace(subject, covariance=covariance)


def test_a_body_known_exactly_has_none_and_uncertain_width_moves_hips_apart():
    assert hip_spread_m(known()) == pytest.approx(0.0, abs=1e-12)
    subject = known(factor_sd=0.1)
    model = HumanModel.of(subject)
    description = model.description
    thigh, width = description.segment("right_thigh"), description.scale_factors.index("pelvis_width")
    moved = 0.1 * thigh.origin_m * description.segment("pelvis").scale_matrix[:, width]
    assert hip_spread_m(subject) == pytest.approx(np.linalg.norm(moved))


def test_markers_that_err_alike_move_the_hips_with_them():
    assert hip_spread_m(known(place_m=(0.003, 0.0, -0.004))) == pytest.approx(0.005, rel=1e-6)


def test_an_uncertain_hip_centre_counts_as_one_of_two():
    assert hip_spread_m(known(right_hip_m=0.02)) == pytest.approx(0.02 / np.sqrt(2.0))


def test_skin_counts_in_flexion_only():
    """Each hip displaces the pelvis's markers."""
    subject = known(slide_m=0.01)
    assert hip_spread_m(subject, 0.0) == pytest.approx(0.0, abs=1e-9)
    assert hip_spread_m(subject, 60.0) == pytest.approx(2 * 0.01 * np.sqrt(3.0), rel=1e-6)
    assert hip_spread_m(subject, 100.0) > hip_spread_m(subject, 60.0)


def test_without_covariance_or_markers_on_the_pelvis_it_is_unknown():
    subject = stander()
    assert hip_spread_m(replace(subject, covariance=None)) is None
    limbs = tuple(m for m in subject.markers if m.segment != "pelvis")
    assert hip_spread_m(replace(subject, markers=limbs)) is None


def test_the_note_states_spread_and_remedy():
    note = hip_note(stander())
    millimetres = round(1e3 * hip_spread_m(stander()))
    assert note.startswith(f"hip centres are uncertain by {millimetres} mm (RMS) in a squat: ")
    assert "deep squat" in note and "--trial" in note and "about 9 mm" in note
    unknown = hip_note(replace(stander(), covariance=None))
    assert unknown.startswith("no deep flexion") and " mm" not in unknown
