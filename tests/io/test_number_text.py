"""Numbers as text: the kernel's digits are Python's, in columns of every kind."""

import numpy as np
import pytest

from mbkf.io import number_text
from mbkf.io.number_text import number_rows
from mbkf.kernel.loading import library

DIGITS = (0, -6, -8, 10, 12, 14)


def numbers():
    """Numbers of all sizes, halves of the last digit, powers of ten and their neighbours."""
    rng = np.random.default_rng(3)
    powers = 10.0 ** np.arange(-16, 18)
    ties = (rng.integers(0, 2**40, 200) + 0.5) / 2.0 ** rng.integers(0, 30, 200)
    sizes = rng.normal(size=3000) * 10.0 ** rng.uniform(-14, 16, 3000)
    rounded = np.round(rng.normal(size=300) * 1e3, 3)
    near = [np.nextafter(powers, 0.0), powers, np.nextafter(powers, np.inf), 9.9999999999995 * powers]
    special = [0.0, -0.0, np.nan, -np.nan, np.inf, -np.inf, 5e-324, 1.7e308]
    found = np.concatenate([ties, sizes, rounded, *near, special])
    return np.concatenate([found, -found])


@pytest.mark.parametrize("digits", [*((n,) for n in DIGITS), (1,), (17,), DIGITS])
def test_rows_are_written_as_python_formats_them(digits):
    values = np.repeat(numbers()[:, None], len(digits), axis=1)
    line = "\t".join(f"%.{n}g" if n > 0 else f"%.{-n}f" for n in digits) + "\n"
    assert "".join(number_rows(values, digits)) == "".join(line % tuple(row) for row in values.tolist())


@pytest.mark.parametrize("kind", [np.float32, np.int64])
def test_rows_of_another_type_and_layout_are_written_too(kind):
    values = (100.0 * np.random.default_rng(6).normal(size=(5, 8))).astype(kind)[::-2, ::2].T
    line = "%.10g\t%.10g\t%.10g\n"
    assert "".join(number_rows(values, [10] * 3)) == "".join(line % tuple(row) for row in values.tolist())


def test_rows_longer_than_a_piece_of_memory_follow_each_other(monkeypatch):
    values = np.random.default_rng(4).normal(size=(50, 6))
    whole = "".join(number_rows(values, DIGITS))
    monkeypatch.setattr(number_text, "BYTES", 1)
    pieces = list(number_rows(values, DIGITS))
    assert "".join(pieces) == whole and len(pieces) == 50


@pytest.mark.skipif(library() is None, reason="compares with the kernel")
def test_the_kernel_writes_usual_numbers_itself():
    values = np.random.default_rng(5).normal(size=(20, 6)) * 1e3
    assert len(list(number_rows(values, DIGITS))) == 1
