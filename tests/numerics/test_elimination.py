"""Frames of a tree are eliminated as dense frames are, and rows of branches have the columns of their branch alone."""

import numpy as np
import pytest

from mbkf.numerics.elimination import Border, eliminate, row_blocks

BRANCHES = ([0, 1, 2], [0, 1, 3, 4], [0, 5])
"""Own unknowns that act on the shared unknowns of each branch; the first ones are the root's."""


def tree(frames=3, each=2):
    """Frames of six own unknowns; a branch has ``each`` shared unknowns."""
    rng = np.random.default_rng(5)
    H, border = np.tile(np.eye(6), (frames, 1, 1)), np.zeros((frames, 6, each * len(BRANCHES)))
    for k, own in enumerate(BRANCHES):
        J = rng.normal(size=(frames, 4, len(own)))
        H[:, np.array(own)[:, None], own] += J.swapaxes(1, 2) @ J
        border[:, own, each * k : each * (k + 1)] = rng.normal(size=(frames, len(own), each))
    return H, Border.plain(border), rng.normal(size=(frames, 6))


def full():
    rng = np.random.default_rng(6)
    A = rng.normal(size=(4, 5, 7))
    return A @ A.swapaxes(1, 2), Border.plain(rng.normal(size=(4, 5, 3))), rng.normal(size=(4, 5))


def repeated(each=2):
    """The tree, whose shared unknowns act twice: by themselves, and by a factor that is zero for one of them."""
    H, border, gradient = tree(each=each)
    rng, count = np.random.default_rng(7), border.columns.shape[2]
    factors = np.hstack([np.ones((len(H), count)), rng.normal(size=(len(H), count))])
    factors[:, count] = 0.0
    return H, Border(border.columns, np.tile(np.arange(count), 2), factors), gradient


@pytest.mark.parametrize("arrow", [tree(), full(), repeated(), repeated(each=8)])
def test_the_elimination_is_the_dense_one(arrow):
    H, border, gradient = arrow
    found = eliminate(H, border, gradient, row_blocks(H, border))
    border = border.terms
    dense = np.linalg.solve(H, border)
    np.testing.assert_allclose(found.complement, (border.swapaxes(1, 2) @ dense).sum(axis=0), atol=1e-12)
    np.testing.assert_allclose(
        found.pull, (dense.swapaxes(1, 2) @ gradient[:, :, None]).sum(axis=0)[:, 0], atol=1e-12
    )
    shared = np.arange(1.0, border.shape[2] + 1.0)
    expected = np.linalg.solve(H, (border @ shared + gradient)[:, :, None])[:, :, 0]
    np.testing.assert_allclose(found.own_step(shared), expected, atol=1e-12)


def test_rows_of_a_branch_have_its_columns_alone():
    H, border, _ = tree()
    columns = {block.rows.start: block.columns.tolist() for block in row_blocks(H, border)}
    assert columns == {0: [4, 5], 1: [2, 3], 3: [0, 1], 4: [0, 1, 2, 3], 5: [0, 1, 2, 3, 4, 5]}


def test_terms_are_columns_times_the_factors_of_frames():
    _, border, _ = repeated()
    expected = np.concatenate([border.columns] * 2, axis=2) * border.factors[:, None]
    np.testing.assert_array_equal(border.terms, expected)
    np.testing.assert_array_equal(border.acting, (expected != 0.0).any(axis=0))
    assert not border.acting[:, 6].any()


def test_a_frame_that_is_not_positive_definite_is_refused():
    H, border, gradient = full()
    with pytest.raises(np.linalg.LinAlgError):
        eliminate(-H, border, gradient, row_blocks(H, border))
