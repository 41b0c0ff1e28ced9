"""Ridge regression of some joints' movement on that of others, with its error on frames left out.

Targets y are predicted from features f as ȳ + Wᵀ (f − f̄), the conditional mean of jointly Gaussian variables with a
ridge λ² on the features' covariance (Bishop, *Pattern Recognition and Machine Learning*, 2006, 2.3.1 and 3.1.4).
Consecutive frames carry nearly the same information, so the errors are those on whole blocks of time left out. A target
that the plain mean of the other blocks predicts as well keeps that mean.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from mbkf.conventions import Array

LEAST_BLOCKS, FEW_BLOCKS, FEW_SCATTER = 4, 2, 2.0
"""With fewer than four blocks the spread of a left-out block (Student's t of one degree less) is not finite. From two
on the plain mean is used then, with this many times its scatter for its error on four blocks."""


@dataclass(frozen=True)
class Coordination:
    """A learned relation.

    Attributes:
        features: (p,) mean f̄ of the features.
        targets: (k,) mean ȳ of the targets.
        weights: (p, k) W; columns of zeros for targets that keep their mean.
        error_sd: (k,) root mean square error on blocks left out.
        novelty: (p, p) K: a variance is larger by the factor 1 + 1/B + (f − f̄)ᵀ K (f − f̄).
        blocks: B, number of blocks.
    """

    features: Array
    targets: Array
    weights: Array
    error_sd: Array
    novelty: Array
    blocks: int

    def predicted(self, features: Array) -> tuple[Array, Array]:
        """Mean (k,) and standard deviation (k,) of the targets at features (p,), wider for unusual features."""
        away = features - self.features
        known, few = 1.0 + 1.0 / self.blocks, (self.blocks - 1) / (self.blocks - 3)
        growth = known + self._reads * (away @ self.novelty @ away)
        return self.targets + away @ self.weights, self.error_sd * np.sqrt(few * growth)

    @cached_property
    def _reads(self) -> Array:
        """(k,) 1 for targets that depend on the features, 0 for those that keep their mean."""
        return self.weights.any(axis=0).astype(float)


def learn(features: Array, targets: Array, blocks: NDArray[np.intp], ridge: float) -> Coordination | None:
    """Relation of targets to features; their mean for few blocks, None for a single one.

    A left-out block's error is (I − H_bb)⁻¹ (y − ŷ)_b with the hat matrix H of all frames, without another fit.

    Args:
        features: (n, p).
        targets: (n, k).
        blocks: (n,) number of the block of time that each frame belongs to.
        ridge: λ, in the features' unit: features that vary by less hardly count.
    """
    names = np.unique(blocks)
    if len(names) < FEW_BLOCKS:
        return None
    n, p = features.shape
    middle, mean = features.mean(axis=0), targets.mean(axis=0)
    if len(names) < LEAST_BLOCKS:
        return Coordination(
            middle,
            mean,
            np.zeros((p, len(mean))),
            FEW_SCATTER * targets.std(axis=0),
            np.zeros((p, p)),
            LEAST_BLOCKS,
        )
    F, Y = features - middle, targets - mean
    K = cho_solve(cho_factor(F.T @ F + n * ridge**2 * np.eye(p)), np.eye(p))
    read = K @ F.T
    weights = read @ Y
    short = Y - F @ weights
    by_features, by_mean = np.empty_like(Y), np.empty_like(Y)
    for name in names:
        own = np.flatnonzero(blocks == name)
        hat = F[own] @ read[:, own] + 1.0 / n
        by_features[own] = np.linalg.solve(np.eye(len(own)) - hat, short[own])
        by_mean[own] = Y[own] + Y[own].sum(axis=0) / (n - len(own))
    sd, plain = (np.sqrt((error**2).mean(axis=0)) for error in (by_features, by_mean))
    weights[:, sd >= plain] = 0.0
    return Coordination(middle, mean, weights, np.minimum(sd, plain), n / len(names) * K, len(names))
