"""Damaged results, truths, logs, records and MATLAB files are refused, however they were cut or changed."""

import json
from functools import partial

import numpy as np
import pytest
import scipy.io

from mbkf.errors import FileFormatError
from mbkf.io.frame_log import FORMAT, FORMAT_VERSION, FrameLogWriter, read_frame_log
from mbkf.io.hdf5 import SEAL, USER_BLOCK
from mbkf.io.imu.files import read_imu
from mbkf.io.results_folder import read_reconstruction, read_summary
from mbkf.io.truth import read_truth
from mbkf.study.batch.curves import read_curves
from mbkf.study.batch.inputs import is_made_from, write_record
from mbkf.viz.report.document import read_labels
from tests.io.damaged.refusal import refusal

HDF5 = b"\x89HDF\r\n\x1a\n"


def header(**changed):
    own = {"format": FORMAT, "format_version": FORMAT_VERSION, "dtype": [["a", "<f8", []]], "header": {}}
    return (json.dumps(own | changed) + "\n").encode()


@pytest.mark.parametrize("read", [read_reconstruction, read_truth], ids=["motion", "truth"])
@pytest.mark.parametrize(
    "content",
    [
        b"", None, b"\0" * 1024, HDF5, HDF5 + bytes(1000), bytes(USER_BLOCK) + HDF5 + bytes(100),
        (SEAL % (8, 0)).ljust(USER_BLOCK, b"\0") + HDF5, (SEAL % (2**60, 0)).ljust(USER_BLOCK, b"\0") + HDF5,
        HDF5 + b"\x00" * 8 + b"\xff" * 2000, b"mbkf: x bytes", bytes(range(256)) * 8,
    ],
    ids=[
        "empty", "folder", "zeros", "signature", "zero superblock", "zero superblock after a block", "wrong checksum",
        "wrong length", "absurd addresses", "half a seal", "all bytes",
    ],
)  # fmt: skip
def test_what_is_no_sealed_file_is_refused(tmp_path, read, content):
    refusal(read, tmp_path / "a.h5", content)


@pytest.mark.parametrize(
    "content",
    [
        b"", None, b"\n", b"\0" * 600, b"[1]\n", b"{}\n", b"[" * 4000, b'{"a":' * 800, b"\xff\xfe{}\n",
        header(format="other"), header(format_version=99), header(format_version=[1]), header(dtype=[]),
        header(dtype=[["a", "O", []]]) + bytes(80), header(dtype=[["a", "<f8", [2**40, 2**40]]]),
        header(dtype=[["a", "<f8", [-1]]]), header(dtype=[["a", "<q99", []]]), header(dtype="<f8"),
        header(dtype=[["a", "<f8", []], ["a", "<f8", []]]), header(header=5), header(format_version=10**30),
    ],
)  # fmt: skip
def test_what_is_no_log_is_refused(tmp_path, content):
    refusal(read_frame_log, tmp_path / "a.log", content)


@pytest.mark.parametrize("cut", [0, 1, 7, 8, 39])
def test_a_row_cut_off_at_the_end_of_a_log_is_left_out(tmp_path, cut):
    path, rows = tmp_path / "a.log", np.arange(10.0).view([("a", "<f8", (1,))])
    with FrameLogWriter(path, rows.dtype, {}) as log:
        log.append(rows)
    path.write_bytes(path.read_bytes()[: -cut or None])
    row = 8 + 4  # and its checksum
    found = read_frame_log(path).rows
    np.testing.assert_array_equal(found["a"].ravel(), np.arange(10.0)[: 10 - -(-cut // row)])


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"[1]",
        b"5",
        b'"x"',
        b"null",
        b"{",
        b"[" * 4000,
        b'{"a":' * 800,
        b"\xff\xfe{}",
        b'{"a": 1' + b"0" * 400 + b"}",
    ],
)
def test_what_is_no_table_of_results_is_refused(tmp_path, content):
    (tmp_path / "result").mkdir()
    refusal(lambda path: read_summary(path.parent), tmp_path / "result" / "summary.json", content)
    refusal(read_labels, tmp_path / "labels.json", content)
    (tmp_path / "batch.json").write_bytes(content)
    assert not is_made_from(tmp_path / "batch.json", {"files": {}, "settings": {}, "version": ""})


def test_a_record_of_other_things_is_no_record(tmp_path):
    made_from = {"files": {"a": "0f"}, "settings": {}, "version": "1"}
    write_record(tmp_path / "batch.json", made_from)
    assert is_made_from(tmp_path / "batch.json", made_from)
    for changed in ({"files": []}, {"files": {"a": None}}, {"settings": 5}, {"version": None}):
        write_record(tmp_path / "batch.json", made_from | changed)
        assert not is_made_from(tmp_path / "batch.json", made_from)


@pytest.mark.parametrize("content", [b"", None, b"PAR1", b"PAR1" + bytes(100) + b"PAR1", b"\xff" * 500])
def test_what_is_no_table_of_curves_is_refused(tmp_path, content):
    refusal(read_curves, tmp_path / "curves.parquet", content)


def mat(path, **content):
    zeros = np.zeros((5, 3))
    scipy.io.savemat(path, {"imu_acc": zeros, "imu_gyr": zeros, "sampling_rate": 100.0} | content)
    return path.read_bytes()


MATS = {
    "empty": lambda path: b"",
    "folder": lambda path: None,
    "only a header": lambda path: mat(path)[:128],
    "cut in a tag": lambda path: mat(path)[:132],
    "cut in a variable": lambda path: mat(path)[:-100],
    "endless variable": lambda path: mat(path)[:132] + b"\xff\xff\xff\xff" + mat(path)[136:],
    "absurd dimensions": lambda path: mat(path)[:160] + b"\xff\xff\xff\x7f" * 2 + mat(path)[168:],
    "rate of 0": partial(mat, sampling_rate=0.0),
    "rate not a number": partial(mat, sampling_rate=np.nan),
    "two rates": partial(mat, sampling_rate=np.ones(2)),
    "no rate": partial(mat, sampling_rate=np.zeros((0, 0))),
    "rate a text": partial(mat, sampling_rate="fast"),
    "readings of four axes": partial(mat, imu_acc=np.zeros((5, 4))),
    "a single reading": partial(mat, imu_acc=1.0),
    "readings of other lengths": partial(mat, imu_gyr=np.zeros((6, 3))),
    "impossible readings": partial(mat, imu_acc=np.full((5, 3), 1e12)),
    "quaternions of three": partial(mat, opt_quat=np.zeros((5, 3))),
    "complex readings": partial(mat, imu_acc=np.zeros((5, 3)) + 1j),
    "version 7.3": lambda path: mat(path)[:124] + b"\x00\x02IM" + mat(path)[128:],
    "version 4": lambda path: bytes(20) + b"imu\0" + bytes(200),
}


@pytest.mark.parametrize("case", MATS)
def test_damaged_matlab_files_are_refused(tmp_path, case):
    content = MATS[case](tmp_path / "whole.mat")
    refusal(read_imu, tmp_path / "a.mat", content)


def test_the_undamaged_matlab_file_is_read(tmp_path):
    mat(tmp_path / "a.mat")
    (one,) = read_imu(tmp_path / "a.mat")
    assert one.rate_hz == 100.0 and one.samples == 5
    with pytest.raises(FileFormatError, match="no such file"):
        read_imu(tmp_path / "b.mat")
