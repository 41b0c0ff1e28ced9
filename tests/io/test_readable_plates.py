"""Plates that cannot be read are left out with their reason; a file without any is an error where one is needed."""

import pytest

from mbkf.errors import FileFormatError, InvalidInput, MbkfError
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.readable_plates import left_out_notes, readable_plates

ERRORS = {
    "1": FileFormatError("a.c3d", "force plate 1 is of type 9"),
    "2": InvalidInput("a.c3d, force plate 2: 3 of 9 samples are not numbers"),
}


def read(name):
    if name in ERRORS:
        raise ERRORS[name]
    return name.upper()


def found(names, options, **needs):
    return readable_plates(((name, name) for name in names), read, options, "a.c3d", **needs)


def test_the_others_are_used_and_the_reasons_kept():
    options = CaptureOptions()
    assert found(["1", "a", "2", "b"], options) == ["A", "B"]
    assert options.left_out == {
        "1": "force plate 1 is of type 9",
        "2": "force plate 2: 3 of 9 samples are not numbers",
    }
    assert left_out_notes(options.left_out) == [
        "force plate 1 is left out: it is of type 9",
        "force plate 2 is left out: 3 of 9 samples are not numbers",
    ]


def test_no_readable_plate_is_an_error_unless_none_is_needed():
    with pytest.raises(FileFormatError, match="type 9"):
        found(["1", "2"], CaptureOptions())
    with pytest.raises(InvalidInput, match="3 of 9"):
        found(["1", "2"], CaptureOptions(unneeded_plates=("1",)))
    assert found(["1"], CaptureOptions(unneeded_plates=("1",))) == []
    assert found(["1", "2"], CaptureOptions(), needs_one=False) == []
    assert found([], CaptureOptions()) == []


def test_other_errors_are_not_caught():
    def fails(_):
        raise MbkfError("another")

    with pytest.raises(MbkfError, match="another"):
        readable_plates([("1", 1)], fails, CaptureOptions(), "a.c3d")


def test_plates_of_one_reason_are_told_together():
    reasons = {str(k): f"force plate {k} has no usable CORNERS" for k in range(1, 9)}
    assert left_out_notes(reasons) == [
        "8 force plates are left out (1, 2, 3, 4, 5, 6 …): each has no usable CORNERS"
    ]
