"""MATLAB files give what scipy reads of them, in either byte order; no size in a damaged one is believed."""

import struct
import zlib

import numpy as np
import pytest
import scipy.io
from hypothesis import given
from hypothesis import strategies as st

from mbkf.io import mat5
from mbkf.io.mat5 import read_mat5


def element(kind, body, order="<", size=None):
    return struct.pack(f"{order}II", kind, len(body) if size is None else size) + body + bytes(-len(body) % 8)


def matrix(values, name=b"a", *, order="<", shape=None, flags=0x0006, data=None):
    shape = shape if shape is not None else np.shape(values)
    body = data if data is not None else np.asarray(values, f"{order}f8").tobytes(order="F")
    return element(
        14,
        element(6, struct.pack(f"{order}II", flags, 0), order)
        + element(5, np.array(shape, f"{order}i4").tobytes(), order)
        + element(1, name, order)
        + element(9, body, order),
        order,
    )


def packed(content, cut=0):
    stream = zlib.compress(content)
    return struct.pack("<II", 15, len(stream) - cut) + stream[: len(stream) - cut]


def written(path, *elements, order="<", version=0x0100):
    mark = b"IM" if order == "<" else b"MI"
    path.write_bytes(bytes(124) + struct.pack(f"{order}H", version) + mark + b"".join(elements))
    return path


@pytest.mark.parametrize("packing", [False, True])
def test_what_scipy_writes_is_read_as_scipy_reads_it(tmp_path, packing):
    rng = np.random.default_rng(1)
    content = {
        "acc": rng.normal(size=(7, 3)), "rate": 100.0, "t": np.arange(7.0), "none": np.zeros((0, 3)),
        "cube": rng.normal(size=(2, 3, 4)), "single": np.float32([[1.5, 2.5]]),
        **{kind: np.arange(6, dtype=kind).reshape(2, 3) for kind in ("i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8")},
        "hip": {"acc": rng.normal(size=(4, 3)), "note": "x", "deep": {"a": 1.0}}, "b": True,
        "text": "abc", "cell": np.array([1.0, "x"], dtype=object), "complex": np.array([1.0 + 2.0j]),
    }  # fmt: skip
    scipy.io.savemat(tmp_path / "a.mat", content, do_compression=packing)
    found = read_mat5(tmp_path / "a.mat")
    expected = scipy.io.loadmat(tmp_path / "a.mat", squeeze_me=True, struct_as_record=False)
    assert found.keys() == content.keys() - {"text", "cell", "complex"}
    assert found["hip"].keys() == {"acc"}
    np.testing.assert_array_equal(found["hip"]["acc"], expected["hip"].acc)
    assert found["none"].shape == (0, 3)  # scipy drops the three
    for name in found.keys() - {"hip", "none"}:
        np.testing.assert_array_equal(found[name], expected[name])
        assert found[name].shape == np.shape(expected[name])


@pytest.mark.parametrize("order", ["<", ">"])
def test_either_byte_order(tmp_path, order):
    values = np.arange(6.0).reshape(3, 2)
    path = written(tmp_path / "a.mat", matrix(values, order=order), order=order)
    np.testing.assert_array_equal(read_mat5(path)["a"], values)


def test_small_elements_and_what_is_no_array(tmp_path):
    small = struct.pack("<I", 1 << 16 | 1) + b"name"[:1] + bytes(3)
    body = element(6, struct.pack("<II", 6, 0)) + element(5, np.int32([1, 2]).tobytes()) + small
    body += struct.pack("<I", 2 << 16 | 2) + bytes([7, 9, 0, 0])
    found = read_mat5(written(tmp_path / "a.mat", element(3, b"1234"), element(14, b""), element(14, body)))
    np.testing.assert_array_equal(found["n"], [7.0, 9.0])


ONE = np.ones((2, 3))
FLAGS, SHAPE, NAME = (
    element(6, struct.pack("<II", 2, 0)),
    element(5, np.int32([1, 1]).tobytes()),
    element(1, b"s"),
)


@pytest.mark.parametrize(
    ("elements", "reason"),
    [
        ([b"\x00\x00"], "cut short within a tag"),
        ([struct.pack("<II", 5 << 16 | 1, 0)], "small element of 5"),
        ([matrix(ONE)[:-8]], "an element of"),
        ([element(14, b"", size=2**32 - 1)], "an element of 4294967295 bytes where 0 are left"),
        ([matrix(ONE, shape=(2**15, 2**15))], "'a' of size 32768 x 32768 has 48 bytes"),
        ([matrix(ONE, shape=(-2, -3))], "dimensions"),
        ([matrix(ONE, shape=(6,))], "dimensions"),
        ([matrix(ONE, shape=[1] * 9)], "dimensions"),
        ([matrix(ONE, data=bytes(47))], "has 47 bytes"),
        ([element(14, element(5, bytes(8)))], "without flags"),
        ([element(14, element(6, struct.pack("<II", 6, 0)))], "without dimensions"),
        ([element(14, element(6, struct.pack("<II", 6, 0)) + SHAPE)], "without a name"),
        ([element(14, element(6, struct.pack("<II", 6, 0)) + SHAPE + NAME)], "'s' holds no numbers"),
        ([element(14, FLAGS + SHAPE + NAME)], "length of its names"),
        ([element(14, FLAGS + SHAPE + NAME + element(5, bytes(4)) + NAME)], "names have 0 letters"),
        ([element(14, FLAGS + SHAPE + NAME + element(5, b"\x01\0\0\0") + NAME)], "fewer fields"),
        ([packed(matrix(ONE), cut=9)], "packed variable"),
        ([packed(matrix(ONE)[:-8])], "not as long as it says"),
        ([packed(matrix(ONE) + b"x")], "not as long as it says"),
        ([packed(b"")], "without a tag"),
        ([packed(element(14, b"", size=2**31))], "of type 14 and 2147483648 bytes"),
        ([packed(element(15, b""))], "of type 15"),
        ([struct.pack("<II", 15, 8) + b"notzlib!"], "is damaged"),
    ],
)
def test_sizes_that_do_not_fit_are_refused(tmp_path, elements, reason):
    with pytest.raises(ValueError, match=reason):
        read_mat5(written(tmp_path / "a.mat", *elements))


def test_versions_that_are_another_format(tmp_path):
    for version, reason in ((0x0200, "save it with -v7"), (0x0300, "not known")):
        with pytest.raises(ValueError, match=reason):
            read_mat5(written(tmp_path / "a.mat", version=version))
    with pytest.raises(ValueError, match="not a MATLAB 5 file"):
        (tmp_path / "a.mat").write_bytes(b"")
        read_mat5(tmp_path / "a.mat")


def test_all_packed_variables_together_are_bounded(tmp_path, monkeypatch):
    one = packed(matrix(np.zeros((100, 100))))
    assert len(one) < 1000
    monkeypatch.setattr(mat5, "MOST_BYTES", 100_000)
    assert len(read_mat5(written(tmp_path / "a.mat", one))) == 1
    with pytest.raises(ValueError, match="and 80056 bytes"):
        read_mat5(written(tmp_path / "a.mat", one, one))


@given(at=st.integers(0, 10_000), value=st.integers(0, 255), cut=st.integers(0, 300))
def test_a_changed_packed_variable_is_read_or_refused(tmp_path_factory, at, value, cut):
    content = bytearray(matrix(ONE))
    content[at % len(content)] = value
    path = tmp_path_factory.mktemp("mat") / "a.mat"
    try:
        found = read_mat5(written(path, packed(bytes(content[: len(content) - cut % 50]))))
    except ValueError:
        return
    assert all(isinstance(one, np.ndarray) and one.size == 6 for one in found.values())
