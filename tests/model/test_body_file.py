"""Body files: a user's own body from anywhere, and what a broken file says in one line."""

import pytest

from mbkf.conventions import data_folder
from mbkf.errors import FileFormatError, MbkfError, UnknownName
from mbkf.model.body_file import load_body, parse_body
from mbkf.model.sides import mirrored

TEXT = (data_folder("models") / "human18.toml").read_text(encoding="utf-8")


@pytest.fixture
def load_changed(tmp_path):
    """Loads the shipped body from a file elsewhere, with one piece of its text replaced."""

    def load(old, new):
        assert old in TEXT
        path = tmp_path / "other.toml"
        path.write_text(TEXT.replace(old, new, 1), encoding="utf-8")
        return load_body(path)

    return load


def test_a_file_from_anywhere_is_read_as_it_stands(load_changed):
    body = load_changed("mass_kg = 14.2", "mass_kg = 14.5")
    assert body.segment("pelvis").mass_kg == 14.5
    assert "mass_kg = 14.5" in body.text
    assert parse_body(body.text, "again").segment("pelvis").mass_kg == 14.5


def test_shipped_bodies_are_read_once_and_carry_no_text():
    assert load_body() is load_body("human18")
    assert load_body().text == ""


def test_unknown_bodies_are_refused_with_the_nearest(tmp_path):
    with pytest.raises(UnknownName, match="did you mean human18"):
        load_body("human81")
    with pytest.raises(FileFormatError, match="cannot be read"):
        load_body(tmp_path / "none.toml")


def test_roles_have_defaults():
    start, end = TEXT.index("leading = ["), TEXT.index("knees = [")
    roles = parse_body(TEXT[:start] + TEXT[end:], "x").roles
    assert (
        roles.leading
        == roles.legs
        == tuple(f"{side}_{part}" for side in ("right", "left") for part in ("thigh", "shank", "foot"))
    )
    assert roles.steady == ("pelvis", "right_foot", "left_foot", "right_toes", "left_toes")


def test_the_left_sole_mirrors_the_right_one():
    right, left = load_body().roles.soles
    assert (right.segment, left.segment) == ("right_foot", "left_foot")
    assert (left.inner_y_m, left.outer_y_m) == (-right.inner_y_m, -right.outer_y_m)
    assert parse_body(TEXT.replace("ball_x_m = 0.13\n", ""), "x").sole == right


def test_the_left_bearings_mirror_the_right_ones():
    """Those of the midline stand alone, and a left one that is written is kept."""
    bearings = load_body().bearings
    assert {"pelvis", "torso"} <= set(bearings)
    for name, one in bearings.items():
        assert one.name == name
        other = bearings.get(mirrored(name))
        assert other is not None and other.segment == mirrored(one.segment)
        assert other.position_m.tolist() == [one.position_m[0], -one.position_m[1], one.position_m[2]]
        assert (other.radius_m, other.lever_m) == (one.radius_m, one.lever_m)
    place = "position_m = [0, 0, 0]\nradius_m = 0.02\nlever_m = 0.03\n"
    own = '[[bearing]]\nname = "left_knee"\nsegment = "left_shank"\n' + place
    changed = parse_body(TEXT + "\n" + own, "x").bearings
    assert changed["left_knee"].radius_m == 0.02
    assert changed["right_knee"].radius_m == bearings["right_knee"].radius_m


def test_a_body_without_bearings_has_none():
    """Older files."""
    start = TEXT.index("[[bearing]]")
    end = TEXT.index("# Shapes for drawing only")
    assert parse_body(TEXT[:start] + TEXT[end:], "x").bearings == {}


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ('name = "human18"', 'name = "human18', "not a valid body description"),
        ("reference_mass_kg = 81.52", "", "lacks 'reference_mass_kg'"),
        ("mass_kg = 14.2", 'mass_kg = "much"', "segment pelvis: could not convert"),
        ("mass_kg = 14.2", "mass_kg = 4.2", "sum to 71.52 kg, but reference_mass_kg is 81.52; add"),
        ("mass_kg = 14.2", "mass_kg = -14.2", "segment pelvis: mass_kg must be positive"),
        ("com_m = [0, 0, -0.211]", "com = [0, 0, -0.211]", "unknown segment entry 'com'; did you mean com_m"),
        ("com_m = [0, 0, -0.211]", "com_m = [0, -0.211]", "segment pelvis: com_m needs three"),
        (
            "inertia_kg_m2 = [0.2464, 0.3719",
            "inertia_kg_m2 = [0.2464, 0.9",
            "torso: a rigid body cannot have the",
        ),
        ("acceleration_sd = [15.0, ", "acceleration_sd = [", "pelvis: acceleration_sd needs 6 numbers"),
        ("limits_deg = [[-40, 40], ", "limits_deg = [", "torso: limits_deg needs 3 pairs"),
        (
            'length_factor = "trunk_height"',
            'length_factor = "trunk"',
            "unknown scale factor 'trunk'; did you",
        ),
        ('scale = ["trunk_depth", ', 'scale = ["mean", "mean", ', "scale needs the names of three factors"),
        ('joint = "hinge"', 'joint = "hing"', "right_toes: unknown joint 'hing'; did you mean hinge"),
        ('axes = "xy"', 'axes = "xx"', "segment neck: a universal joint has 2 axes"),
        ('axes = "xy"', 'axes = "yx"', "clinical joint neck: order 'xy' does not suit"),
        ('parent = "torso"', 'parent = "chest"', "segment neck: its parent 'chest' is not a segment"),
        ('parent = "right_forearm"', 'parent = "neck"', "right_hand must follow its parent neck"),
        ('name = "left_thigh"', 'name = "right_thigh"', "two segments are named right_thigh"),
        ('root = "pelvis"', 'root = "torso"', "the first segment, and no other"),
        ('feet = ["right_foot", "left_foot"]', 'feet = ["right_foot"]', "feet must name two segments"),
        ('feet = ["right_foot", ', 'feet = ["rigth_foot", ', "unknown segment 'rigth_foot'; did you mean"),
        (
            'toes = ["right_toes", "left_toes"]',
            'toes = ["left_toes", "right_toes"]',
            "must be children of the feet",
        ),
        ('knees = [["right_thigh", ', 'knees = [["right_foot", ', "pairs of thigh and shank"),
        ("leading = [", "leeding = [", "unknown roles entry 'leeding'; did you mean leading"),
        ("toe_x_m = 0.205", "toe_m = 0.205", "toe_m"),
        ("toe_x_m = 0.205", "toe_x_m = 0.1", "must grow"),
        ("outer_y_m = -0.055", "outer_y_m = 0.055", "must lie to the right"),
        ('segment = "foot"\n', 'segment = "feet"\n', "unknown segment 'right_feet'; did you mean"),
        ('distal = "head"', 'distal = "neck"', "no clinical joint has the distal segment head"),
        ('proximal = "neck"', 'proximal = "torso"', "the parent of head is neck, not torso"),
        ('main = "lumbar_extension"', 'main = "lumbar"', "main angle lumbar"),
        ('kind = "tube"', 'kind = "tub"', "kind 'tub' is not one of"),
        ("lever_m = 0.12", "", "lever_m"),
        ("lever_m = 0.12", "lever_m = 0", "radius_m and lever_m are positive"),
        (
            "position_m = [0.01, 0.0, -0.03]",
            "position_m = [0.01, 0.0]",
            "right_knee: position_m needs three",
        ),
        (
            "position_m = [0.01, 0.0, -0.03]",
            "position_m = [nan, 0, 0]",
            "right_knee: position_m needs three",
        ),
        ('segment = "right_shank"\nposition_m', 'segment = "shin"\nposition_m', "unknown segment 'shin'"),
        ("numbers = [0.056, 0.05]", "numbers = [0.056]", "shape of neck: limb needs 2 numbers, not 1"),
    ],
)
def test_broken_bodies_are_refused_in_one_line(load_changed, old, new, complaint):
    with pytest.raises(MbkfError) as caught:
        load_changed(old, new)
    assert complaint in str(caught.value)
    assert "\n" not in str(caught.value)
    assert "other.toml" in str(caught.value)
