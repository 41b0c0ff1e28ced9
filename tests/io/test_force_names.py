"""Columns rendered in any laboratory's naming are grouped into the sets they came from."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.any_capture.dialects import NAMINGS
from mbkf.errors import FileFormatError, UnknownName
from mbkf.io.force_names import ForceColumn, force_column, force_sets

PARTS = [f"{kind}{axis}" for kind in "vpm" for axis in "xyz"]
WORDS = {
    "FX1 X1 MX1": lambda name, part: f"{ {'v': 'F', 'p': '', 'm': 'M'}[part[0]] }{part[1].upper()}{name}",
    "Force Plate 1 - COPx (mm)": lambda name, part: (
        f"Force Plate {name} - { {'v': 'F', 'p': 'COP', 'm': 'M'}[part[0]] }{part[1]} (N.mm)"
    ),
    "ground_force_calcn_1_vx": lambda name, part: f"ground_force_calcn_{name}_{part}",
    "GRF_x_1": lambda name, part: f"{ {'v': 'GRF', 'p': 'CoP', 'm': 'GRM'}[part[0]] }_{part[1]}_{name}",
}
DIALECTS = {name: naming for name, (naming, _) in NAMINGS.items()} | WORDS


@given(
    dialect=st.sampled_from(sorted(DIALECTS)),
    plates=st.lists(st.sampled_from(["1", "2", "3", "7", "12"]), min_size=1, max_size=4, unique=True),
    data=st.data(),
)
def test_columns_in_any_order_are_grouped_back(dialect, plates, data):
    named = {(plate, part): DIALECTS[dialect](plate, part) for plate in plates for part in PARTS}
    order = data.draw(st.permutations(sorted(named)))
    names = ["time", *(named[key] for key in order)]
    sets = force_sets(names, "a.mot")
    firsts = list(dict.fromkeys(plate for plate, part in order if part[0] == "v"))
    assert [one.name.removeprefix("calcn_") for one in sets] == firsts
    for plate, one in zip(firsts, sets, strict=True):
        found = [names[index] for group in (one.force, one.point, one.moment) for index in group]
        assert found == [named[plate, part] for part in PARTS]


@given(
    side=st.sampled_from(["r", "l", "left", "right", "R", "LEFT", "left_belt"]),
    dialect=st.sampled_from(["ground_force_r_vx", "R_ground_force_vx", "ground_force_1_mx", "GRF_x_1"]),
)
def test_sides_name_sets(side, dialect):
    (one,) = force_sets([DIALECTS[dialect](side, part) for part in PARTS], "a.mot")
    assert one.name == side.lower()
    assert one.force + one.point + one.moment == tuple(range(9))


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("ground_force_vx", ForceColumn("", "force", 0, 14)),
        ("ground_force_1_mx", ForceColumn("1", "moment", 0, 16)),
        ("1_ground_torque_x", ForceColumn("1", "moment", 0, 16)),
        ("COPxL", ForceColumn("l", "point", 0, 3)),
        ("Y3", ForceColumn("3", None, 1, 0)),
        ("p2_3", ForceColumn("2", "point", 2, 3)),
        ("Fz [N]", ForceColumn("", "force", 2, 1)),
        ("time", None),
        ("Sub Frame", None),
        ("Time (Seconds)", None),
        ("mm.N", None),
        ("F1", None),
    ],
)
def test_what_a_name_says(name, expected):
    assert force_column(name) == expected


def test_the_same_names_again_are_another_set():
    first, second = force_sets(
        ["Fx", "Fy", "Fz", "Cx", "Cy", "Cz", "Fx", "Fy", "Fz", "Cx", "Cy", "Cz"], "a.csv"
    )
    assert (first.name, first.force, first.point) == ("1", (0, 1, 2), (3, 4, 5))
    assert (second.name, second.force, second.point) == ("2", (6, 7, 8), (9, 10, 11))


def test_what_may_be_missing():
    (one,) = force_sets(["Fx", "Fy", "Fz", "COPx", "COPy", "Mz"], "a.csv")
    assert one.point == (3, 4, None)
    assert one.moment == (None, None, 5)
    (bare,) = force_sets(["Fx", "Fy", "Fz"], "a.csv")
    assert bare.point == bare.moment == (None, None, None)


@pytest.mark.parametrize(
    ("names", "missing"),
    [
        (["ground_force_r_vx", "ground_force_r_vz"], "ground_force_r_vy of set 'r'"),
        (["FX1", "FY1", "FZ1", "X1"], "Y1 of set '1'"),
        (["f1_1", "f1_2", "f1_3", "m1_1", "m1_2"], "m1_3 of set '1'"),
    ],
)
def test_a_missing_column_is_named(names, missing):
    with pytest.raises(FileFormatError, match=f"column {missing}"):
        force_sets(names, "a.mot")


def test_a_table_without_forces_is_refused():
    with pytest.raises(UnknownName, match=r"a\.mot: unknown ground reaction columns 'knee, hip'"):
        force_sets(["knee", "hip"], "a.mot")
