"""Sealed HDF5 files are read by any program, and by this one only as they were written."""

from io import BytesIO

import h5py
import numpy as np
import pytest

from mbkf.io.hdf5 import USER_BLOCK, array, check_seal, sealed


@pytest.fixture
def path(tmp_path):
    made = BytesIO()
    with h5py.File(made, "w", userblock_size=USER_BLOCK) as file:
        file.create_dataset("values", data=np.arange(1000.0), compression="gzip")
    found = tmp_path / "x.h5"
    found.write_bytes(sealed(made))
    return found


def test_a_sealed_file_is_read_by_any_program(path):
    check_seal(path)
    with h5py.File(path, "r") as file:
        np.testing.assert_array_equal(array(file, "values"), np.arange(1000.0))
        assert array(file, "values", np.float32).dtype == np.float32
    assert path.read_bytes().startswith(b"mbkf: ")


@pytest.mark.parametrize("at", [0, 8, 512, 600, -1])
def test_a_changed_byte_is_known(path, at):
    content = bytearray(path.read_bytes())
    content[at] ^= 1
    path.write_bytes(content)
    with pytest.raises(ValueError, match="checksum"):
        check_seal(path)


def test_a_file_cut_short_is_known(path):
    path.write_bytes(path.read_bytes()[:-7])
    with pytest.raises(ValueError, match="checksum"):
        check_seal(path)


def test_files_of_before_have_no_seal(tmp_path):
    with h5py.File(tmp_path / "old.h5", "w") as file:
        file["values"] = np.zeros(3)
    check_seal(tmp_path / "old.h5")


def test_nothing_larger_than_the_file_can_hold_is_asked_for(tmp_path):
    with h5py.File(tmp_path / "x.h5", "w") as file:
        file.create_dataset("values", shape=(10**12,), chunks=(1000,), dtype="f8")
    with (
        h5py.File(tmp_path / "x.h5", "r") as file,
        pytest.raises(ValueError, match="more than the file can hold"),
    ):
        array(file, "values")
