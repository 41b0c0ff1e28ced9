"""Packed arrays: HDF5's own filters read what was written, and noise costs no more than its bytes."""

import zlib

import h5py
import numpy as np
import pytest

from mbkf.io.packed_arrays import CHUNK_BYTES, packed, packed_dataset, put_packed, write_packed

RNG = np.random.default_rng(3)
ARRAYS = {
    "noise": RNG.standard_normal((3001, 40)),
    "noise of three axes": RNG.standard_normal((700, 2, 3, 3)),
    "constant": np.full((5000, 9), 0.25),
    "gaps": np.where(RNG.random((900, 6)) < 0.3, np.nan, RNG.standard_normal((900, 6))),
    "single precision": RNG.standard_normal((4000, 30)).astype(np.float32),
    "bytes from high to low": RNG.standard_normal((900, 7)).astype(">f8"),
    "infinite": np.full((700, 3), -np.inf),
    "every third row": RNG.standard_normal((900, 7))[::-3],
    "codes": RNG.integers(0, 3, (60_000, 5)).astype(np.int8),
    "truth values": RNG.random(70_000) < 0.5,
    "numbers": np.arange(90_000),
    "other order of axes": np.asfortranarray(RNG.standard_normal((2000, 50))),
    "one row": RNG.standard_normal((1, CHUNK_BYTES // 4)),
    "random bytes": RNG.integers(0, 256, 200_001).astype(np.uint8),
}


@pytest.mark.parametrize("name", sorted(ARRAYS))
def test_hdf5_reads_the_array_as_it_is(tmp_path, name):
    values = ARRAYS[name]
    with h5py.File(tmp_path / "a.h5", "w") as file:
        write_packed(file, "a", values)
    with h5py.File(tmp_path / "a.h5") as file:
        found = file["a"][()]
        assert file["a"].shuffle and file["a"].compression == "gzip"
    assert found.dtype == values.dtype and found.shape == values.shape
    assert found.tobytes() == np.ascontiguousarray(values).tobytes()


def test_noise_costs_its_bytes_and_exponents_less():
    values = np.random.default_rng(5).uniform(0.5, 1.0, 30_000)  # one exponent, 52 bits of noise
    noise = 6.5 * len(values)
    assert noise < len(packed(values)) < 1.02 * 7 * len(values)
    assert len(packed(np.zeros(30_000))) < 0.02 * 8 * 30_000


def test_a_stream_is_one_of_zlib_with_the_bytes_in_the_order_of_shuffle():
    values = np.random.default_rng(7).standard_normal((40_000, 2))
    bytes_of = np.frombuffer(zlib.decompress(packed(values)), np.uint8).reshape(8, -1)
    assert np.array_equal(bytes_of.T.reshape(-1), values.reshape(-1).view(np.uint8))


def test_chunks_share_the_frames_evenly(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        dataset = write_packed(file, "a", np.zeros((CHUNK_BYTES // 8 + 1, 1)))
        assert dataset.chunks == (CHUNK_BYTES // 16 + 1, 1)


def test_pieces_are_the_chunks_of_a_dataset(tmp_path):
    values = np.asfortranarray(np.random.default_rng(8).standard_normal((2 * 700 + 123, 4, 3)))
    with h5py.File(tmp_path / "a.h5", "w") as file:
        dataset = packed_dataset(file, "a", values.shape, values.dtype, 700)
        for begin in (0, 700, 1400):
            put_packed(dataset, values[begin : begin + 700], begin)
    with h5py.File(tmp_path / "a.h5") as file:
        np.testing.assert_array_equal(file["a"][()], values)
        assert file["a"].id.get_num_chunks() == 3
