"""Words of conventions: every curve has a title and a sense in each language, and charts state axes."""

import pytest

from mbkf.trial.gait.convention import BY_CLINIC, BY_ISB, BY_MODEL, convention_of
from mbkf.viz.convention_words import angle_positive, angle_title, moment_note, moment_title, notes, statement


@pytest.mark.parametrize("language", ["en", "es"])
def test_every_clinical_curve_has_its_words(language):
    for name in (name for row in BY_CLINIC.rows for name in row):
        assert angle_title(language, BY_CLINIC, name, "-") != "-"
    for name in sorted(BY_CLINIC.reversed_angles):
        assert angle_positive(language, BY_CLINIC, name, "-") != "-"
        assert angle_positive(language, BY_ISB, name, "-") == "-"
    for kind in ("internal", "external"):
        for name in sorted(BY_CLINIC.reversed_moments):
            assert moment_title(language, convention_of("clinical", kind), name, "-") != "-"


def test_one_moment_has_two_names():
    external = convention_of("clinical", "external")
    assert moment_title("en", BY_CLINIC, "knee_angle", "") == "Knee extensor moment"
    assert moment_title("en", external, "knee_angle", "") == "External knee flexion moment"
    assert moment_title("en", BY_CLINIC, "arm_flex", "own") == "own", "moments of arms are the body's"
    assert "internal" in moment_note("en", BY_CLINIC, "") and "external" in moment_note("en", external, "")
    assert moment_note("en", BY_ISB, "own") == "own"


def test_charts_state_convention_and_axes():
    assert statement("en", BY_CLINIC, ("pig",)) == "clinical, Plug-in Gait axes"
    assert statement("es", BY_CLINIC, ("model",)) == "clínica, ejes propios del cuerpo"
    assert statement("en", BY_MODEL, ("model", "pig")) == "mbkf, axes differ between trials"
    assert len(notes("en", BY_CLINIC, ("pig",))) == 2 and len(notes("en", BY_MODEL, ("model",))) == 1
