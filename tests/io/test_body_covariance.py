"""What is not known of a body: read back as written, singular or not, and told for markers in any order."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.errors import FileFormatError, ShapeError
from mbkf.io.body_covariance import COVARIANCE, DIGITS, BodyCovariance, read_covariance
from mbkf.io.packed_triangle import packed
from mbkf.io.subject import read_subject, write_subject
from mbkf.io.toml import Entries, Origin
from tests.io.reconstructions import made_up

NAMES = st.lists(
    st.text(st.characters(exclude_categories=["C"]), min_size=1, max_size=6), unique=True, max_size=3
)


RIGID = np.zeros((0, 9, 9))


def made(factors, markers, seed=0, rank=None, flexions=0):
    """A covariance of random errors, of full rank by default."""
    rng, size = np.random.default_rng(seed), len(factors) + 3 * len(markers) * (1 + flexions)
    some = rng.normal(size=(size, size if rank is None else rank)) * 10.0 ** rng.uniform(-5, -1, (size, 1))
    return BodyCovariance.of(tuple(factors), tuple(markers), some @ some.T, flexions), some @ some.T


def read(table):
    return read_covariance(Entries(COVARIANCE, table, Origin(Path("subject.toml"))))


@given(NAMES, NAMES, st.integers(0, 99), st.integers(0, 2))
@settings(max_examples=30, deadline=None)
def test_it_is_read_back_to_the_digits_written(factors, markers, seed, flexions):
    known, covariance = made(factors, markers, seed, flexions=flexions)
    found = read(known.as_table())
    assert (found.factors, found.markers, found.flexions) == (known.factors, known.markers, flexions)
    sd = np.sqrt(np.diag(covariance))
    np.testing.assert_allclose(np.linalg.norm(found.root, axis=1), sd, rtol=10.0 ** (1 - DIGITS))
    assert (np.abs(found.root - known.root) <= 1e-5 * sd[:, None]).all()


def test_files_of_older_versions_have_the_rows_themselves():
    known, _ = made(["a"], ["A"])
    rows = [row[: n + 1].tolist() for n, row in enumerate(known.root)]
    np.testing.assert_array_equal(read({"factors": ["a"], "markers": ["A"], "root": rows}).root, known.root)


@pytest.mark.parametrize("rank", [None, 3, 0])
def test_the_root_is_lower_triangular_and_the_covariance_its_square(rank):
    known, covariance = made(["a", "b"], ["A", "B"], rank=rank)
    assert not np.triu(known.root, 1).any() and (np.diag(known.root) >= 0.0).all()
    np.testing.assert_allclose(known.covariance, covariance, atol=1e-12 * np.abs(covariance).max(initial=1.0))


def test_markers_come_in_any_order_and_one_that_scaling_did_not_see_by_itself():
    known, covariance = made(["a"], ["A", "B", "C"])
    rows = known.rows(["C", "new", "A"], {"A": 9.0, "new": 0.02}, RIGID)
    found = rows @ rows.T
    place = [0, 7, 8, 9, 1, 2, 3]
    seen = [0, 1, 2, 3, 7, 8, 9]
    np.testing.assert_allclose(
        found[np.ix_(seen, seen)], covariance[np.ix_(place, place)], rtol=1e-9, atol=1e-12
    )
    np.testing.assert_allclose(found[4:7, 4:7], 0.02**2 * np.eye(3), rtol=1e-12)
    assert not found[4:7][:, seen].any()


@pytest.mark.parametrize("flexions", [0, 2])
def test_displacements_that_scaling_did_not_learn_have_the_spread_of_the_body_file(flexions):
    """Those of a marker that it saw are its own; of another one, and of all where it learnt none, the prior's."""
    rng, count = np.random.default_rng(1), 1 + 3 * 2 * (1 + flexions)
    some = 0.01 * rng.normal(size=(count, count))
    known = BodyCovariance.of(("a",), ("A", "B"), some @ some.T, flexions)
    skin = np.array([(d + 1) * (np.eye(6) + 0.5) for d in range(2)]) * 1e-4
    rows = known.rows(["B", "new"], {"new": 0.02}, skin)
    found = rows @ rows.T
    for d in range(2):
        start = 1 + 6 * (1 + d)
        of_b, of_new = slice(start, start + 3), slice(start + 3, start + 6)
        np.testing.assert_allclose(found[of_new, of_new], skin[d][3:, 3:], rtol=1e-9)
        if flexions:
            stored = slice(1 + 6 * (1 + d) + 3, 1 + 6 * (1 + d) + 6)
            np.testing.assert_allclose(found[of_b, of_b], known.covariance[stored, stored], rtol=1e-9)
            np.testing.assert_allclose(found[of_b, 0], known.covariance[stored, 0], rtol=1e-9)
        else:
            np.testing.assert_allclose(found[start : start + 6, start : start + 6], skin[d], rtol=1e-9)


@pytest.mark.parametrize(
    ("change", "error", "reason"),
    [
        ({"root": [[1.0], [1.0]]}, FileFormatError, "root must be rows"),
        ({"root": [[float("nan")]]}, FileFormatError, "root must be rows"),
        ({"root": [[1.0]], "markers": ["A"]}, ShapeError, "root"),
        ({"root": [["x"]]}, FileFormatError, "root must be rows"),
        ({"root": [[3.0]]}, FileFormatError, "the standard deviation of a is 3, more than 2"),
        ({"sd": [1.0], "packed_root": "x"}, FileFormatError, "packed_root is damaged, or not of 1 rows"),
        ({"packed_root": packed(np.eye(1))}, FileFormatError, "sd is missing"),
        (
            {"sd": [3.0], "packed_root": packed(np.eye(1))},
            FileFormatError,
            "the standard deviation of a is 3, more than 2",
        ),
        ({"factor": ["a"]}, FileFormatError, "unknown covariance entry 'factor'; did you mean factors"),
    ],
)
def test_a_table_that_is_no_covariance_is_refused(change, error, reason):
    table = {"factors": ["a"], "markers": [], "root": [[1.0]]}
    assert read(table).covariance == [[1.0]]
    with pytest.raises(error, match=reason):
        read({**table, **change})


def test_subject_files_have_it_or_not(tmp_path):
    """A file without it, older or edited, counts as a body known exactly; a cut row is refused in one line."""
    subject, path = made_up().subject, tmp_path / "subject.toml"
    write_subject(subject, path)
    assert read_subject(path).covariance is None
    known, _ = made(["head"], ["A", "B"])
    write_subject(replace(subject, covariance=known), path)
    np.testing.assert_allclose(read_subject(path).covariance.root, known.root, rtol=1e-5)
    text = path.read_text(encoding="utf-8")
    start = text.index("packed_root")
    path.write_text(text[: start + 30] + "!" + text[start + 31 :], encoding="utf-8")
    with pytest.raises(FileFormatError, match="covariance: packed_root is damaged, or not of 7 rows"):
        read_subject(path)


def test_a_table_without_a_root_is_refused():
    with pytest.raises(FileFormatError, match="packed_root is missing; scale the person again"):
        read({"factors": ["a"], "markers": []})
