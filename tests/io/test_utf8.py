"""Every text can be stored, and one that could be before stays."""

import json
import os
import tomllib
from dataclasses import replace

import h5py
import numpy as np
import pytest

from mbkf.io.quantities_h5 import write_labels
from mbkf.io.storage import Table, read_storage, write_storage
from mbkf.io.toml import write_toml
from mbkf.io.utf8 import encoded, storable

ODD = os.fsdecode(b"walk\xff\xe9")


@pytest.mark.parametrize("text", ["", "plain", "é…😀", "a\x00b"])
def test_other_texts_stay(text):
    assert storable(text) == text
    assert encoded(text) == text.encode()


def test_halves_of_letters_are_codes():
    assert storable(ODD) == "walk\\udcff\\udce9"
    assert encoded(ODD).decode() == storable(ODD)


def test_toml_files_can_be_read_again(tmp_path):
    write_toml(tmp_path / "a.toml", ODD, {ODD: ODD, "long": f"{ODD}\nsecond"})
    with (tmp_path / "a.toml").open("rb") as file:
        assert tomllib.load(file) == {storable(ODD): storable(ODD), "long": f"{storable(ODD)}\nsecond"}


def test_hdf5_files_hold_utf_8(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        write_labels(file, "names", [ODD, "é"], ODD)
        assert [one.decode("utf-8") for one in file["names"][:]] == [storable(ODD), "é"]
        assert file["names"].attrs["long_name"] == storable(ODD)


def test_hdf5_files_hold_noughts_as_codes(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        write_labels(file, "names", ["a\0b", "c"], "x\0")
        assert [one.decode("utf-8") for one in file["names"][:]] == ["a\\x00b", "c"]
        assert file["names"].attrs["long_name"] == "x\\x00"


def test_tables_of_any_name_are_written(tmp_path):
    table = Table(("a",), np.array([0.0]), np.array([[1.0]]))
    path = tmp_path / f"{ODD}.mot"
    write_storage(table, path)
    assert path.read_bytes().decode("utf-8").startswith(storable(ODD))
    assert read_storage(path).names == replace(table).names
    assert json.dumps(storable(ODD))
