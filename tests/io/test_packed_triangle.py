"""Triangles as compact text: read back to the share of each row's largest number, again and again, or refused."""

import base64
import zlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.io.packed_triangle import BITS, BYTES, WIDTH, packed, unpacked

SHARE = 1.0 / 2 ** (BITS - 1)
"""One step of a number, of its row's largest one."""


def triangle(seed, size):
    """Rows of very different sizes, some of them zero."""
    rng = np.random.default_rng(seed)
    rows = 10.0 ** rng.uniform(-6, 1, (size, 1)) * (rng.random((size, 1)) < 0.9)
    return np.tril(rows * rng.normal(size=(size, size)))


@given(st.integers(0, 10**6), st.integers(0, 40))
@settings(max_examples=40, deadline=None)
def test_every_number_is_read_back_to_its_rows_step(seed, size):
    known = triangle(seed, size)
    norms = np.linalg.norm(known, axis=1)
    text = packed(known)
    found = unpacked(text, norms)
    largest = np.abs(known).max(axis=1, initial=0.0)[:, None]
    assert (np.abs(found - known) <= 1.1 * SHARE * largest).all()
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), norms, rtol=1e-12)
    assert packed(found) == text
    assert max(map(len, text.splitlines())) <= WIDTH


def test_a_covariance_keeps_its_smallest_directions():
    rng = np.random.default_rng(1)
    some = rng.normal(size=(60, 60)) * np.geomspace(1.0, 1e-2, 60)
    known = np.linalg.cholesky(some @ some.T)
    found = unpacked(packed(known), np.linalg.norm(known, axis=1))
    whitened = np.linalg.solve(known, found)
    np.testing.assert_allclose(np.linalg.svd(whitened, compute_uv=False), 1.0, atol=1e-3)


def test_the_bytes_are_those_of_the_documentation():
    """Two rows of one and two numbers: the lowest bytes, then the middle, then the highest ones."""
    text = packed(np.array([[2.0, 0.0], [-3.0, 1.5]]))
    held = np.frombuffer(zlib.decompress(base64.b64decode(text)), np.uint8).reshape(BYTES, 3).astype(int)
    numbers = held[0] + 256 * held[1] + 65536 * held[2] - 2**19
    np.testing.assert_array_equal(numbers, [2**19 - 1, -(2**19 - 1), 2**18])


@pytest.mark.parametrize(
    "damage",
    [
        lambda text: text[: len(text) // 2],
        lambda text: "!" + text[1:],
        lambda text: "",
        lambda text: base64.b64encode(zlib.compress(b"\0" * 10**6)).decode(),
        lambda text: packed(np.eye(4)),
    ],
)
def test_damaged_text_is_no_triangle(damage):
    assert unpacked(damage(packed(triangle(1, 5))), np.ones(5)) is None
