"""The truth file: what is written is read back, and anything else is refused in one line."""

import h5py
import numpy as np
import pytest

from mbkf.errors import FileFormatError, ShapeError
from mbkf.io.quantities import quantities
from mbkf.io.truth import Truth, read_truth, write_truth
from tests.sealed import unsealed


def made(**changes):
    rng = np.random.default_rng(0)
    parts = {
        "times_s": np.arange(4.0), "q": rng.normal(size=(4, 8)), "v": rng.normal(size=(4, 7)),
        "a": rng.normal(size=(4, 7)), "tau": rng.normal(size=(4, 7)), "foot_wrench": rng.normal(size=(4, 2, 6)),
        "centre_of_pressure": np.full((4, 2, 3), np.nan), "marker_names": ("A", "B"),
        "markers_m": rng.normal(size=(4, 2, 3)), "dof_names": tuple("abcdefg"), "version": "0",
        "settings": {"motion": "squat", "seed": 3},
    }  # fmt: skip
    return Truth(**{**parts, **changes})


def test_round_trip(tmp_path):
    truth = made()
    write_truth(truth, tmp_path / "truth.h5")
    back = read_truth(tmp_path / "truth.h5")
    for name, one in quantities(Truth).items():
        if not one.is_text:
            assert np.array_equal(getattr(back, name), getattr(truth, name), equal_nan=True)
    assert (back.marker_names, back.dof_names, back.version, back.settings) == (
        truth.marker_names,
        truth.dof_names,
        truth.version,
        truth.settings,
    )


def test_what_bears_besides_the_feet_is_read_back_and_may_be_missing(tmp_path):
    wrench = np.random.default_rng(1).normal(size=(4, 2, 6))
    write_truth(made(support_names=("pelvis", "right_hand"), support_wrench=wrench), tmp_path / "truth.h5")
    back = read_truth(tmp_path / "truth.h5")
    assert back.support_names == ("pelvis", "right_hand")
    assert np.array_equal(back.support_wrench, wrench)
    with unsealed(tmp_path / "truth.h5") as file:
        del file["support_names"], file["support_wrench"]
    older = read_truth(tmp_path / "truth.h5")
    assert older.support_names == ()
    assert older.support_wrench.shape == (4, 0, 6)
    with pytest.raises(ShapeError, match="support_wrench"):
        made(support_names=("pelvis",), support_wrench=wrench)


def test_arrays_carry_their_unit(tmp_path):
    write_truth(made(), tmp_path / "truth.h5")
    with h5py.File(tmp_path / "truth.h5") as file:
        for name, one in quantities(Truth).items():
            if not one.is_text:
                assert file[name].attrs["unit"] == one.unit.text
        assert file["tau"].dims[1][0].name == "/dof_names"


def test_wrong_shapes_are_refused():
    with pytest.raises(ShapeError, match="foot_wrench"):
        made(foot_wrench=np.zeros((4, 6)))


def test_other_files_are_refused(tmp_path):
    with pytest.raises(FileFormatError, match="no such file"):
        read_truth(tmp_path / "missing.h5")
    (tmp_path / "text.h5").write_text("hello")
    with pytest.raises(FileFormatError, match="damaged"):
        read_truth(tmp_path / "text.h5")
    h5py.File(tmp_path / "other.h5", "w").close()
    with pytest.raises(FileFormatError, match="not a truth file"):
        read_truth(tmp_path / "other.h5")
