"""Displacements of the shoulders as unknowns of scaling: one of each shoulder in each trial.

Frames of a trial share them (:mod:`mbkf.sensors.shoulder_girdle`). Among what all frames share they follow the factors.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.model.description import BodyDescription
from mbkf.numerics.positive import eliminated
from mbkf.scaling.records import ScalingPrior
from mbkf.sensors.shoulder_girdle import ShoulderGirdle, girdle_prior

RAISED = 0.46
"""f of an arm at 45°: shoulders stay on the trunk where no arm is raised beyond it, here or where one was scaled.
Set on gait2354, HC032A, HC044A and the rajagopal walk (benchmark ``real_truth``)."""


class TrialShoulders:
    """G shoulders in the T trials of N frames.

    Attributes:
        girdle: The markers that move with them.
        of_trial: (N, T) 1 for the trial of a frame.
    """

    def __init__(self, girdle: ShoulderGirdle, trial: NDArray[np.intp]) -> None:
        """Counts the trials.

        Args:
            girdle: The markers that move with the shoulders.
            trial: (N,) number of the trial of each frame.
        """
        self.girdle = girdle
        self.of_trial = np.eye(1 + trial.max(initial=0))[trial]

    def of_frames(self, chosen: NDArray[np.intp]) -> TrialShoulders:
        """The trials of some of the frames.

        Args:
            chosen: Numbers of the frames.
        """
        other = TrialShoulders(self.girdle, np.zeros(0, dtype=np.intp))
        other.of_trial = self.of_trial[chosen]
        return other

    def displaced_m(self, girdle_m: Array) -> Array | None:
        """(N, G, 3) the displacements (3 T G,) in every frame, along the trunk's axes; None without any."""
        if not girdle_m.size:
            return None
        frames, trials = self.of_trial.shape
        return np.asarray(self.of_trial @ girdle_m.reshape(trials, -1)).reshape(frames, -1, 3)

    def by_displacements(self, trunks: Array) -> Array:
        """(N, M, 3, 3 T G) derivative of the markers by the displacements.

        Args:
            trunks: (N, G, 3, 3) axes of the trunk of each shoulder.
        """
        found = np.einsum("mg,nt,ngij->nmitgj", self.girdle.carried, self.of_trial, trunks)
        return np.asarray(found.reshape(*found.shape[:3], -1))

    def expected(
        self, prior: ScalingPrior, body: BodyDescription, poses: Array, standing: Array | None = None
    ) -> ScalingPrior:
        """A prior with displacements as the arms' elevation in each trial lets expect, if arms are raised in any.

        Args:
            prior: The prior of other unknowns.
            body: The reference body.
            poses: (N, nq) configurations.
            standing: (nq,) that in which the person was scaled before.
        """
        frames = np.maximum(self.of_trial.sum(axis=0), 1.0)
        raised = (self.of_trial / frames).T @ self.girdle.raised(poses)
        before = np.zeros(0) if standing is None else self.girdle.raised(standing)
        if max(raised.max(initial=0.0), before.max(initial=0.0)) < RAISED:
            return prior
        mean, covariance = girdle_prior(body, raised)
        return replace(prior, girdle_m=mean, girdle_covariance=covariance)


def without_shoulders(information: Array, prior: ScalingPrior, before: int) -> Array:
    """Information on what frames share, with the shoulders' displacements eliminated.

    Args:
        information: That on all of it.
        prior: Prior of the same problem.
        before: Number of unknowns before the displacements.
    """
    return eliminated(information, np.arange(before, before + prior.raised))
