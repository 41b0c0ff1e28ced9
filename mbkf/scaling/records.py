"""Settings, weights, prior and state of scaling."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.linalg import block_diag

from mbkf.conventions import Array, BoolArray, read_only


@dataclass(frozen=True)
class ScalingSettings:
    """Weights of the priors of scaling.

    Attributes:
        proportion_sd: Spread of a factor about the person's overall size.
        side_sd: Spread of a factor about the mean of both sides; a person's limbs differ by a hundredth in length.
        stature_sd: Spread of overall size when no height is given.
        known_stature_sd: Spread of overall size when the height is given.
        standing_sd_rad: Spread of a joint's angle about neutral in a static trial, rad.
        static_posture_frames: Number of independent observations of the posture in a static trial.
        dynamic_posture_frames: The same in a dynamic trial.
        dynamic_marker_frames: Number of independent observations of the markers in a dynamic trial: skin moves with the
            posture and not anew in every frame.
        skin: Fit the markers' displacements by flexion, where a trial moves.
        thesis_factors: Scale by the thesis's factors: one that the body file splits equals its origin. The default
            departs from thesis Table 4.1, where pelvis and torso have one vertical factor.
        frames_per_trial: Greatest number of frames taken from one trial.
        outlier_m: Distance from the fitted body beyond which a sample is left out, m.
        correct_names: Put names right that a static trial exchanges (:mod:`mbkf.scaling.standing_names`).
    """

    proportion_sd: float = 0.06
    side_sd: float = 0.015
    stature_sd: float = 0.20
    known_stature_sd: float = 0.02
    standing_sd_rad: float = 0.14
    static_posture_frames: float = 1.0
    dynamic_posture_frames: float = 1.0
    dynamic_marker_frames: float = 15.0
    skin: bool = True
    thesis_factors: bool = False
    frames_per_trial: int = 40
    outlier_m: float = 0.06
    correct_names: bool = True


RIGID = read_only(np.zeros((0, 0, 3)))
"""Displacements of markers whose skin does not move with the posture."""

FIXED = read_only(np.zeros(0))
"""Displacements of shoulders that stay on the trunk."""


@dataclass(frozen=True)
class ScalingState:
    """One point of the search.

    Attributes:
        poses: (N, nq) configurations.
        factors: (K,) scale factors.
        offsets_m: (M, 3) offsets of the markers.
        slides_m: (D, M, 3) their displacements by flexion.
        girdle_m: (3 T G,) displacements of G shoulders in T trials.
    """

    poses: Array
    factors: Array
    offsets_m: Array
    slides_m: Array = field(default_factory=lambda: RIGID)
    girdle_m: Array = field(default_factory=lambda: FIXED)


@dataclass(frozen=True)
class FrameWeights:
    """Weights of N frames.

    Attributes:
        markers: (N,) independent observations of the markers.
        posture: (N,) independent observations of the posture.
        standing: (N,) True where the person stands straight.
        upright: (N,) weight of flat feet and an upright root.
    """

    markers: Array
    posture: Array
    standing: BoolArray
    upright: Array

    @classmethod
    def moving(cls, frames: int, markers: float, posture: float) -> FrameWeights:
        """Frames of a movement.

        Args:
            frames: Number of frames.
            markers: Observations of the markers in all of them, at most one in each.
            posture: The same for the posture.
        """
        of_markers, of_posture = (
            np.full(frames, min(1.0, count / max(1, frames))) for count in (markers, posture)
        )
        return cls(of_markers, of_posture, np.zeros(frames, dtype=bool), np.zeros(frames))


@dataclass(frozen=True)
class ScalingPrior:
    """Prior knowledge of factors, offsets and displacements by flexion.

    Attributes:
        factors: (K,) expected scale factors k₀.
        factor_covariance: (K, K) their covariance.
        offsets_m: (M, 3) expected offsets δ₀ of the markers.
        offset_precision: (3 M, 3 M) inverse covariance of the offsets, 1/m², marker by marker.
        slides_m: (D, M, 3) expected displacements by flexion c₀.
        slide_precision: (3 M, 3 M) inverse covariance of those of one flexion; flexions are independent. Without
            rows the displacements are known, and are no unknowns.
        girdle_m: (3 T G,) expected displacements h₀ of G shoulders in T trials; no numbers where shoulders stay on the
            trunk.
        girdle_covariance: (3 T G, 3 T G) their covariance; without rows the displacements are known.
    """

    factors: Array
    factor_covariance: Array
    offsets_m: Array
    offset_precision: Array
    slides_m: Array = field(default_factory=lambda: RIGID)
    slide_precision: Array = field(default_factory=lambda: np.zeros((0, 0)))
    girdle_m: Array = field(default_factory=lambda: FIXED)
    girdle_covariance: Array = field(default_factory=lambda: np.zeros((0, 0)))

    @property
    def flexions(self) -> int:
        """Number of flexions whose displacements are unknown."""
        return len(self.slides_m) if self.slide_precision.size else 0

    @property
    def raised(self) -> int:
        """3 T G: number of unknown displacements of the shoulders."""
        return len(self.girdle_covariance)

    def without_girdle(self) -> ScalingPrior:
        """The prior with known displacements of the shoulders."""
        return replace(self, girdle_covariance=np.zeros((0, 0)))

    @property
    def precision(self) -> Array:
        """(K + 3 T G + 3 M (1 + D), …) inverse covariance of factors, shoulders, offsets and unknown displacements."""
        blocks = [np.linalg.inv(self.factor_covariance)]
        if self.raised:
            blocks.append(np.linalg.inv(self.girdle_covariance))
        return block_diag(*blocks, self.offset_precision, *[self.slide_precision] * self.flexions)

    def away(self, state: ScalingState) -> Array:
        """(K + 3 T G + 3 M (1 + D),) the unknowns of a state that frames share, minus the expected ones."""
        slides = (state.slides_m - self.slides_m) if self.flexions else RIGID
        girdle = (state.girdle_m - self.girdle_m) if self.raised else FIXED
        offsets = (state.offsets_m - self.offsets_m).ravel()
        return np.concatenate([state.factors - self.factors, girdle, offsets, slides.ravel()])


@dataclass(frozen=True)
class ShownMarkers:
    """Errors of N frames of M markers with derivatives, whitened; 0 where a marker is missing.

    Attributes:
        errors: (N, M, 3) modelled minus measured.
        by_pose: (N, M, 3, nv) derivative by the frame's pose.
        by_factors: (N, M, 3, K + 3 T G) by the scale factors and unknown displacements of the shoulders.
        axes: (N, M, 3, 3) by the marker's own offset.
        shares: (1 + D, N, M) 1 and f: derivative by an unknown displacement, over that by the offset.
    """

    errors: Array
    by_pose: Array
    by_factors: Array
    axes: Array
    shares: Array
