"""The registries of file formats: suffixes, content, a reader of the user's own."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io import capture as captures
from mbkf.io.capture import CAPTURES, read_capture, register_reader, writable_suffixes, write_capture
from mbkf.io.imu.files import read_imu, register_imu_reader
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.readers import FOLDER, FileFormat, FormatRegistry, either
from mbkf.io.records import Capture, MarkerTrajectories, PlateReadings
from tests.io.c3d_builder import standing_points


def numbers(path: Path, _options) -> Capture:
    positions = np.loadtxt(path).reshape(-1, 8, 3)
    return Capture(str(path), MarkerTrajectories(tuple("abcdefgh"), positions, 100.0))


@pytest.mark.usefixtures("registries")
def test_a_reader_of_ones_own_is_used_and_listed(tmp_path):
    read = register_reader(".num", title="numbers", forces_share_up=True)(numbers)
    assert read is numbers
    np.savetxt(tmp_path / "a.NUM", 1e-3 * standing_points(20).reshape(20, -1))
    found = read_capture(tmp_path / "a.NUM")
    np.testing.assert_allclose(found.markers.positions_m, 1e-3 * standing_points(20))
    with pytest.raises(FileFormatError, match=r"\.c3d, \.trc, \.csv, \.tsv or \.num"):
        read_capture(tmp_path / "a.xlsx")
    with pytest.raises(FileFormatError, match=r"numbers is not written; name a \.c3d or \.trc file"):
        write_capture(found, tmp_path / "b.num")


@pytest.mark.usefixtures("registries")
def test_forces_of_a_reader_of_ones_own_join_a_capture(tmp_path):
    force = np.tile([0.0, 0.0, 700.0], (50, 1))
    plate = PlateReadings("p", 100.0, 0.0, np.zeros(3), force, 0.0 * force, 0.0 * force, 20.0)
    told = []

    @captures.register_force_reader(".grf", title="test")
    def read_grf(_path, options):
        told.append(options)
        return (plate,)

    write_capture(numbers_capture(), tmp_path / "a.trc")
    found = read_capture(tmp_path / "a.trc", forces=tmp_path / "a.grf", tare=False)
    assert found.plates == (plate,)
    assert (told[0].tare, told[0].up) == (False, None)
    with pytest.raises(
        FileFormatError, match=r"cannot be read as ground reactions; name a \.mot, \.sto, .* or \.grf"
    ):
        read_capture(tmp_path / "a.trc", forces=tmp_path / "a.xlsx")


def numbers_capture() -> Capture:
    return Capture("", MarkerTrajectories(tuple("abcdefgh"), standing_points(20) / 1e3, 100.0))


@pytest.mark.parametrize("suffix", writable_suffixes())
def test_what_can_be_written_is_read_again(suffix, tmp_path):
    write_capture(numbers_capture(), tmp_path / f"a{suffix}")
    found = read_capture(tmp_path / f"a{suffix}")
    np.testing.assert_allclose(found.markers.positions_m, standing_points(20) / 1e3, atol=1e-6)


@pytest.mark.usefixtures("registries")
def test_a_reader_that_recognises_its_files_shares_a_suffix(tmp_path):
    one = ImuReadings("s", np.arange(3.0), np.zeros((3, 3)), np.zeros((3, 3)), None, 1.0)

    def mine(path):
        return path.read_text().startswith("MINE")

    @register_imu_reader(".csv", title="mine", recognises=mine)
    def read_mine(_path, _options):
        return (one,)

    (tmp_path / "a.csv").write_text("MINE\n")
    assert read_imu(tmp_path / "a.csv") == (one,)
    (tmp_path / "b.csv").write_text("t,acc_x [g],acc_y [g],acc_z [g]\n0,0,0,1\n1,0,0,1\n")
    assert read_imu(tmp_path / "b.csv")[0].specific_force_mps2[0, 2] > 9.8


def test_suffixes_are_checked():
    registry: FormatRegistry[FileFormat] = FormatRegistry("tests")
    registry.add(FileFormat(title="one", suffixes=(".one", FOLDER)))
    assert registry.suffixes == (".one",)
    for wrong in ("one", ".One"):
        with pytest.raises(InvalidInput, match="lower-case suffix"):
            registry.add(FileFormat(title="x", suffixes=(wrong,)))
    with pytest.raises(InvalidInput, match="read as one already"):
        registry.add(FileFormat(title="two", suffixes=(".two", ".one")))


def test_alternatives_in_words():
    assert [either(names) for names in (("a",), ("a", "b"), ("a", "b", "c"))] == ["a", "a or b", "a, b or c"]


def test_suffixes_are_known_without_heavy_libraries():
    code = "import sys, mbkf.io.capture, mbkf.io.imu.files; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert not {"ezc3d", "scipy", "h5py", "pinocchio"} & set(loaded.split())


def test_a_function_is_imported_at_its_first_call():
    code = "import sys\nfrom mbkf.io.readers import lazily\nnorms = lazily('norms', 'read_norms')\n"
    code += "before = 'mbkf.io.norms' in sys.modules\ntry:\n    norms('none.toml')\n"
    code += (
        "except Exception as error:\n    print(before, type(error).__name__, 'mbkf.io.norms' in sys.modules)"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert shown.split() == ["False", "FileFormatError", "True"]


def test_help_texts_list_suffixes_without_a_look_up():
    assert CAPTURES.suffixes_so_far[:4] == (".c3d", ".trc", ".csv", ".tsv")
