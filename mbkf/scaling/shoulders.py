"""Displacements of the shoulders as unknowns of scaling: one of each shoulder in each trial with raised arms.

Frames of a trial share them (:mod:`mbkf.sensors.shoulder_girdle`). Among what all frames share they follow the factors.
Where arms hang shoulders stay on the trunk, so that such trials place them for the trials without displacements.
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
"""f of an arm at 45°: shoulders stay on the trunk in a trial without an arm beyond it, unless one was scaled with it.
Set on gait2354, HC032A, HC044A and the rajagopal walk (benchmark ``real_truth``)."""


class TrialShoulders:
    """G shoulders in the T trials of N frames that displace them.

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

    def raised(self, poses: Array, standing: Array | None = None) -> TrialShoulders:
        """The trials in which an arm is raised; all of them where one was in the pose of an earlier scaling.

        Args:
            poses: (N, nq) configurations.
            standing: (nq,) that in which the person was scaled before.
        """
        highest = self._mean_elevations(poses).max(axis=1, initial=0.0)
        if standing is not None:
            highest = np.maximum(highest, self.girdle.raised(standing).max(initial=0.0))
        other = self.of_frames(np.zeros(0, dtype=np.intp))
        other.of_trial = self.of_trial[:, highest >= RAISED]
        return other

    def _mean_elevations(self, poses: Array) -> Array:
        """(T, G) f of the trials at configurations (N, nq)."""
        frames = np.maximum(self.of_trial.sum(axis=0), 1.0)
        return np.asarray((self.of_trial / frames).T @ self.girdle.raised(poses))

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

    def expected(self, prior: ScalingPrior, body: BodyDescription, poses: Array) -> ScalingPrior:
        """A prior with displacements as the arms' elevation in each trial lets expect, if there are any.

        Args:
            prior: The prior of other unknowns.
            body: The reference body.
            poses: (N, nq) configurations.
        """
        if not self.of_trial.shape[1]:
            return prior
        mean, covariance = girdle_prior(body, self._mean_elevations(poses))
        return replace(prior, girdle_m=mean, girdle_covariance=covariance)


def without_shoulders(information: Array, prior: ScalingPrior, before: int) -> Array:
    """Information on what frames share, with the shoulders' displacements eliminated.

    Args:
        information: That on all of it.
        prior: Prior of the same problem.
        before: Number of unknowns before the displacements.
    """
    return eliminated(information, np.arange(before, before + prior.raised))
