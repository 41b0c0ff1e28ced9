"""Imported norms: statements that lack are named, signs and units are the convention's, the cycle has 101 points."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.norm_files.raw import RawBand, RawNorms
from mbkf.study.session.norm_import import Statements, imported, span_of
from tests.io.norm_files.made import KNEE, KNEE_SD, MOMENT, MOMENT_SD, PERCENT

STATED = Statements("n", "Rossi 2019", "clinical", "", 30, (20.0, 40.0), (1.1, 1.4))
KNEE_BAND = RawBand("Knee flexion", KNEE, KNEE_SD, PERCENT, unit="deg")
MOMENT_BAND = RawBand("knee extensor moment", MOMENT, MOMENT_SD, PERCENT, unit="Nm/kg")


def raw(*bands, **statements):
    return RawNorms("table", bands or (KNEE_BAND, MOMENT_BAND), statements)


def one(band, **stated):
    return next(iter(imported(raw(band), replace(STATED, **stated)).norms.curves.items()))


def test_points_between_are_those_of_the_curve():
    (key, band) = one(KNEE_BAND)
    assert key == ("walk", "angle", "knee_angle") and (band.unit, band.persons) == ("deg", 30)
    t = 2.0 * np.pi * np.linspace(0.0, 1.0, 101)
    np.testing.assert_allclose(band.mean, 20.0 + 25.0 * np.sin(t), atol=1e-3)
    np.testing.assert_allclose(band.sd, 4.0 + np.cos(t), atol=0.005)
    np.testing.assert_array_equal(band.mean[::2], KNEE)
    fractions = one(replace(KNEE_BAND, percent=PERCENT / 100.0))[1]
    np.testing.assert_allclose(fractions.mean, band.mean)


@pytest.mark.parametrize(
    ("label", "convention", "moments", "factor"),
    [
        ("knee flexion", "clinical", "", 1.0), ("knee extension", "clinical", "", -1.0),
        ("knee extension", "model", "", -1.0), ("pelvis_tilt", "model", "", 1.0),
        ("anterior pelvic tilt", "clinical", "", 1.0), ("anterior pelvic tilt", "model", "", -1.0),
        ("knee extensor moment", "clinical", "", 1.0), ("knee extensor moment", "model", "", -1.0),
        ("knee flexion moment", "clinical", "internal", -1.0), ("knee flexion moment", "clinical", "external", 1.0),
        ("external knee adduction moment", "clinical", "", 1.0), ("external knee adduction moment", "model", "", -1.0),
        ("knee ext/flexion moment", "clinical", "", 1.0), ("HipMoment", "model", "", -1.0),
        ("hip power", "model", "", 1.0),
        ("posterior grf", "clinical", "", -1.0),
    ],
)  # fmt: skip
def test_signs_are_those_of_the_convention(label, convention, moments, factor):
    unit = "W/kg" if "power" in label else "BW" if "grf" in label else "N m/kg" if "oment" in label else "deg"
    band = replace(KNEE_BAND, label=label, unit=unit, component="X" if label == "HipMoment" else "")
    _, found = one(band, convention=convention, moments=moments)
    np.testing.assert_allclose(found.mean[::2], factor * KNEE * (100.0 if unit == "BW" else 1.0))
    assert (found.sd > 0.0).all()


@pytest.mark.parametrize(
    ("unit", "label", "shown", "factor"),
    [("rad", "knee flexion", "deg", 180.0 / np.pi), ("N·mm/kg", "knee extensor moment", "N m/kg", 1e-3),
     ("N/kg", "vertical grf", "% BW", 100.0 / 9.80665), ("", "knee flexion", "deg", 1.0),
     ("", "knee power", "W/kg", 1.0)],
)  # fmt: skip
def test_units_become_those_of_reports(unit, label, shown, factor):
    _, found = one(replace(KNEE_BAND, unit=unit, label=label))
    assert found.unit == shown
    np.testing.assert_allclose([found.mean[::2], found.sd[::2]], factor * np.array([KNEE, KNEE_SD]))


@pytest.mark.parametrize(
    ("lacking", "sentence"),
    [({"convention": ""}, "# convention: clinical'"), ({"source": ""}, "# source: "), ({"persons": 0}, "# persons: "),
     ({"ages": None}, "# age: "), ({"speeds": None}, "# speed: ")],
)  # fmt: skip
def test_a_statement_that_lacks_is_named(lacking, sentence):
    with pytest.raises(InvalidInput, match=sentence):
        imported(raw(), replace(STATED, **lacking))


def test_the_file_may_state_it_all():
    said = {"source": "x", "convention": "Clinical", "persons": "12", "age": "20-40", "speed": "1,1–1,4 m/s"}
    norms = imported(raw(**said), Statements()).norms
    assert (norms.name, norms.source, norms.convention, norms.axes) == ("x", "x", "clinical", "pig")
    assert norms.ages == (20.0, 40.0) and norms.speeds == (1.1, 1.4)
    assert {band.persons for band in norms.curves.values()} == {12}


def test_curves_that_are_not_known_are_listed_with_the_reason():
    bands = [
        replace(KNEE_BAND, label="wrist flexion"),
        replace(MOMENT_BAND, unit=""),
        replace(MOMENT_BAND, label="hip flexion moment"),
        replace(KNEE_BAND, label="hip flexion", sd=0.0 * KNEE),
        replace(KNEE_BAND, label="hip adduction", sd=-KNEE_SD),
        replace(KNEE_BAND, label="hip rotation", percent=0.5 * PERCENT),
        replace(KNEE_BAND, label="knee varus", percent=PERCENT[::-1]),
        RawBand("knee rotation", KNEE[:9], KNEE_SD[:9], PERCENT[:9]),
        replace(KNEE_BAND, label="ankle dorsiflexion", unit="", mean=KNEE / 57.3),
        replace(KNEE_BAND, label="ankle dorsiflexion", unit="N m/kg"),
    ]
    found = imported(raw(KNEE_BAND, *bands), STATED)
    assert list(found.norms.curves) == [("walk", "angle", "knee_angle")]
    for one_reason, fragment in zip(
        found.left_out,
        ["no curve of mbkf", "unit is not stated", "internal or external", "no spread", "negative", "from 0 to 50 %",
         "do not increase", "9 points", "may be radians", "'N m/kg' is not known"],
        strict=True,
    ):  # fmt: skip
        assert fragment in one_reason
    assert found.turned == ()
    assert imported(raw(replace(KNEE_BAND, label="knee extension")), STATED).turned == ("knee extension",)
    trunk = replace(KNEE_BAND, label="trunk forward tilt")
    assert "no such curve" in imported(raw(KNEE_BAND, trunk), replace(STATED, convention="isb")).left_out[0]


def test_groups_are_chosen_with_their_speeds():
    groups = [replace(KNEE_BAND, group=name, mean=KNEE + k) for k, name in enumerate(("Free", "Slow"))]
    with pytest.raises(InvalidInput, match="the groups Free, Slow; state the one"):
        imported(raw(*groups), STATED)
    with pytest.raises(InvalidInput, match="no group 'Fast'"):
        imported(raw(*groups), replace(STATED, groups={"Fast": None}))
    norms = imported(raw(*groups), replace(STATED, groups={"Free": None, "Slow": (0.7, 1.0)})).norms
    key = ("walk", "angle", "knee_angle")
    np.testing.assert_array_equal(norms.curves[key].mean[::2], KNEE)
    np.testing.assert_array_equal(norms.by_speed[0.7, 1.0][key].mean[::2], KNEE + 1.0)


@pytest.mark.parametrize(
    ("bands", "stated", "message"),
    [
        ((KNEE_BAND, KNEE_BAND), {}, "stands twice"),
        ((replace(KNEE_BAND, label="nose"),), {}, "no curve is left of the file's 1: nose"),
        ((), {"convention": "isb", "moments": "external"}, "belong to the clinical convention"),
        ((), {"convention": "vicon"}, "vicon"),
    ],
)
def test_other_norms_are_refused(bands, stated, message):
    with pytest.raises(Exception, match=message):
        imported(raw(*bands), replace(STATED, **stated))


@pytest.mark.parametrize("text", ["", "young", "40-20"])
def test_ranges_that_are_none(text):
    with pytest.raises(InvalidInput, match=r"no range|greater number"):
        span_of(text)


def test_measures_keep_their_kind():
    measure = RawBand(
        "Speed", np.array([1.2]), np.array([0.1]), np.empty(0), quantity="measure", unit="m/s", persons=5
    )
    norms = imported(raw(KNEE_BAND, measure), STATED).norms
    assert norms.measures["walk", "Speed"].mean[0] == 1.2 and norms.measures["walk", "Speed"].persons == 5
