"""Model outputs are told from markers by the file's own lists and by names that markers never have."""

import pytest

from mbkf.io.derived import classify, group_kinds, segment_axes

MARKERS = ["LFHD", "T1", "T10", "C7", "CLAV", "STRN", "SACR", "LASI", "RTH1", "RTH2", "LTIB", "LHFB", "RLFC"]


def test_markers_stay_markers():
    assert classify([*MARKERS, "*0", "*12", "Top.Head", "L.Toe.Tip"], {}) == {}


def test_what_the_file_lists_wins():
    assert classify(["PELO", "CLAV"], {"CLAV": "angle"}) == {"CLAV": "angle"}


@pytest.mark.parametrize(
    ("label", "kind"),
    [
        ("LHipAngles", "angle"),
        ("RAbsAnkleAngle", "angle"),
        ("LKneeMoment", "moment"),
        ("RGroundReactionForce", "force"),
        ("LNormalisedGRF", "force"),
        ("RHipPower", "power"),
        ("LArchHeightIndex", "scalar"),
        ("CentreOfMass", "point"),
        ("CentreOfMassFloor", "point"),
        ("LHJC", "point"),
        ("R_KJC", "point"),
    ],
)
def test_names_of_model_outputs(label, kind):
    assert classify([*MARKERS, label], {}) == {label: kind}


def test_segment_axes_need_all_four_ends():
    labels = ["PELO", "PELA", "PELL", "PELP", "LTOO", "LTOA", "LTOL", "CLAP", "CLAO"]
    assert segment_axes(labels) == {"PELO", "PELA", "PELL", "PELP"}


def test_points_of_the_foot_model_only_count_beside_its_signature():
    assert classify(["LTIB", "LTIB1", "LANK1"], {}) == {}
    found = classify(["LTIB", "LTIB1", "LANK1", "LHDF0", "projLTIB"], {})
    assert found == dict.fromkeys(["LTIB1", "LANK1", "LHDF0", "projLTIB"], "point")


def test_groups_a_file_declares():
    kinds = group_kinds({"TYPE_GROUPS": ["ANGLES", "ANGLE", "BONES", "BONE", "TORQUES", "MOMENT"]})
    assert (kinds["ANGLES"], kinds["BONES"], kinds["TORQUES"]) == ("angle", "point", "moment")
    assert group_kinds({})["POWERS"] == "power"
