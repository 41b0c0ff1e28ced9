"""Parameters are found in any case, with their continuations, cut per plate."""

import numpy as np

from mbkf.io.c3d_parameters import C3dParameters


def parameters(**groups) -> C3dParameters:
    return C3dParameters(
        {group: {name: value for name, value in items.items()} for group, items in groups.items()}
    )


def test_lists_continue_under_numbered_names():
    found = parameters(POINT={"LABELS": ["a ", "b"], "labels2": [" c"], "LABELS3": ["d"], "LABELS5": ["x"]})
    assert found.texts("point", "labels") == ["a", "b", "c", "d"]
    assert found.text("POINT", "LABELS") == "a"


def test_missing_or_unsuitable_values_are_empty():
    found = parameters(POINT={"RATE": np.array([100.0]), "UNITS": []})
    assert found.number("POINT", "RATE") == 100.0
    assert found.number("POINT", "NONE", 7.0) == 7.0
    assert found.text("POINT", "UNITS") == ""
    assert found.numbers("POINT", "UNITS").size == 0
    assert parameters(P={"X": ["text"]}).numbers("P", "X").size == 0


def test_single_numbers_leave_lists_texts_and_what_is_no_number_out():
    values = {
        "LKneeWidth": np.array([124.0]),
        "Name": ["x"],
        "Two": np.array([1.0, 2.0]),
        "Bad": np.array([np.nan]),
    }
    assert parameters(Processing=values).single_numbers("PROCESSING") == {"LKNEEWIDTH": 124.0}
    assert parameters().single_numbers("PROCESSING") == {}


def test_blocks_of_plates_follow_fortran_order():
    corners = np.arange(24.0).reshape(3, 4, 2)
    channel = np.arange(12.0).reshape(6, 2)
    found = parameters(FORCE_PLATFORM={"CORNERS": corners, "CHANNEL": channel, "ORIGIN": np.zeros((3, 1))})
    blocks = found.per_plate("CORNERS", (3, 4))
    np.testing.assert_array_equal(blocks[0], corners[:, :, 0])
    np.testing.assert_array_equal(blocks[1], corners[:, :, 1])
    np.testing.assert_array_equal(found.per_plate("CHANNEL", (-1,))[1], channel[:, 1])
    assert len(found.per_plate("ORIGIN", (3,))) == 1
    assert found.per_plate("CAL_MATRIX", (6, 6)) == []
