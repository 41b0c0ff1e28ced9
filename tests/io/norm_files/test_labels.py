"""Names of curves: outputs of Plug-in Gait, variables of GCD files, and words with their directions."""

import pytest

from mbkf.io.norm_files.labels import GCD_VARIABLES, NamedCurve, curve_of


@pytest.mark.parametrize(
    ("label", "component", "name", "sense"),
    [
        ("HipAngles", "X", "hip_flexion", 1),
        ("RKneeAngles", "Y", "knee_adduction", 1),
        ("PelvisAngles", "Z", "pelvis_rotation", 1),
        ("FootProgressAngles", "Z", "foot_progression", 1),
        ("FootAngles", "Z", "foot_progression", 1),
        ("ThoraxAngles", "X", "trunk_tilt", 1),
        ("KneeValgVar", "", "knee_adduction", 1),
        ("FootRotation", "", "ankle_rotation", 1),
        ("Pelvic Ant/Posterior Tilt", "", "pelvis_tilt", 1),
        ("Pelvic Int/Ext", "", "pelvis_rotation", 1),
        ("Pelvic Up/Dn", "", "pelvis_list", 1),
        ("Hip Flx/Ext", "", "hip_flexion", 1),
        ("Hip Ad/Abduction", "", "hip_adduction", 1),
        ("Hip Int/External Rotation", "", "hip_rotation", 1),
        ("hip ext rot", "", "hip_rotation", -1),
        ("Knee extension", "", "knee_angle", -1),
        ("knee valgus", "", "knee_adduction", -1),
        ("Knee angle", "", "knee_angle", None),
        ("Ankle Dor/Pla", "", "ankle_angle", 1),
        ("plantar flexion ankle", "", "ankle_angle", -1),
        ("Foot Int/External Progression", "", "foot_progression", 1),
        ("Posterior pelvic tilt", "", "pelvis_tilt", -1),
        ("pelvis_tilt", "", "pelvis_tilt", None),
        ("Trunk Up/Down Obliquity", "", "trunk_obliquity", 1),
    ],
)
def test_angles(label, component, name, sense):
    assert curve_of(label, component) == NamedCurve("angle", name, sense)


@pytest.mark.parametrize(
    ("label", "component", "name", "sense", "frame"),
    [
        ("HipMoment", "X", "hip_flexion", -1, "internal"),
        ("AnkleMoment", "X", "ankle_angle", -1, "internal"),
        ("KneeValgVarMoment", "", "knee_adduction", -1, "internal"),
        ("Hip Extensor Moment ", "", "hip_flexion", -1, "internal"),
        ("Plantarflexor Moment", "", "ankle_angle", -1, "internal"),
        ("external knee adduction moment", "", "knee_adduction", 1, "external"),
        ("knee flexion moment", "", "knee_angle", 1, ""),
        ("internal hip abduction moment", "", "hip_adduction", -1, "internal"),
        ("hip internal rotation moment", "", "hip_rotation", 1, ""),
        ("Hip Ext/Flexion Moment", "", "hip_flexion", None, ""),
    ],
)
def test_moments(label, component, name, sense, frame):
    assert curve_of(label, component) == NamedCurve("torque", name, sense, frame)


def test_powers_reactions_and_what_a_column_states():
    assert curve_of("HipPower", "Z") == curve_of("Hip power") == curve_of("Hip", quantity="power")
    assert curve_of("Hip", quantity="power") == NamedCurve("power", "hip")
    assert (
        curve_of("Vertical GRF")
        == curve_of("Vertical", quantity="reaction")
        == NamedCurve("reaction", "upward", 1)
    )
    assert curve_of("Posterior ground reaction force") == NamedCurve("reaction", "forward", -1)
    assert curve_of("Hip Ext/Flexion", quantity="torque") == NamedCurve("torque", "hip_flexion")
    assert curve_of("medial", quantity="reaction") == NamedCurve("reaction", "medial")


@pytest.mark.parametrize(
    ("label", "component", "quantity"),
    [
        ("AnkleAngles", "Y", ""), ("AnkleMoment", "Z", ""), ("HipPower", "X", ""), ("WristAngles", "X", ""),
        ("Hip angle", "", ""), ("Foot rotation", "", ""), ("Foot progression moment", "", ""),
        ("Rectus Femoris", "", ""),
        ("Pelvis power", "", ""), ("Ankle inversion", "", ""), ("side", "", "reaction"), ("PelvisMoment", "X", ""),
    ],
)  # fmt: skip
def test_other_names_mean_no_curve(label, component, quantity):
    assert curve_of(label, component, quantity) is None


def test_every_variable_of_gcd_is_an_output():
    assert all(curve_of(name) is not None for name in GCD_VARIABLES)
