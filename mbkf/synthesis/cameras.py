"""Errors of cameras on true markers: noise, moving skin, occlusions, ghost reflections, lost labels."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput, NotConverged
from mbkf.io.subject import Subject
from mbkf.model.body import Body
from mbkf.sensors.flexed_skin import FlexedSkin

OCCLUSION_FRAMES = 20

MOST_STREAKS = 100
"""Most streaks for each sample of a capture; to hide all samples takes a handful."""

GHOST_SECONDS = (0.2, 1.0)


def true_markers(model: Body, subject: Subject, q: Array) -> Array:
    """(T, M, 3) exact positions of the subject's markers, m.

    Args:
        model: The subject's scaled body.
        subject: Markers with their segments and places.
        q: (T, nq) configurations.
    """
    joints = np.array([model.joint(marker.segment).joint_id for marker in subject.markers])
    local = _local(model, subject, q)
    positions = np.empty((len(q), len(joints), 3))
    for k, configuration in enumerate(q):
        rotations, origins = model.placements(configuration)
        positions[k] = origins[joints] + np.einsum("mij,mj->mi", rotations[joints], local[k])
    return positions


def _local(model: Body, subject: Subject, q: Array) -> Array:
    """(T, M, 3) places in the segments' frames, with skin that moves by the flexions of its joints, m."""
    neutral = np.array([marker.neutral_m for marker in subject.markers])
    flexions = max((len(marker.slides_m) for marker in subject.markers), default=0)
    if not flexions:
        return np.broadcast_to(neutral, (len(q), *neutral.shape))
    slides = np.zeros((len(neutral), flexions, 3))
    for own, marker in zip(slides, subject.markers, strict=True):
        own[: len(marker.slides_m)] = marker.slides_m
    skin = FlexedSkin(model, [marker.segment for marker in subject.markers])
    shares = np.array([skin.shares(configuration) for configuration in q])[:, :, :flexions]
    return np.asarray(neutral + np.einsum("tmd,mdi->tmi", shares, slides))


def skin_artefact(
    shape: tuple[int, ...], rate_hz: float, sd_m: float, cutoff_hz: float, rng: np.random.Generator
) -> Array:
    """Movement of the skin: low-passed white noise with a stationary standard deviation.

    A causal second-order Butterworth filter runs over white noise along the first axis; its burn-in is dropped
    and it is scaled by the root of its impulse response's energy.

    Args:
        shape: (T, ...) of the result.
        rate_hz: Sample rate.
        sd_m: Standard deviation per coordinate, m.
        cutoff_hz: Cut-off frequency.
        rng: Source of the noise.
    """
    from scipy.signal import butter, lfilter

    b, a = butter(2, cutoff_hz, fs=rate_hz)
    settled = int(np.ceil(5.0 / cutoff_hz * rate_hz))
    impulse = lfilter(b, a, np.r_[1.0, np.zeros(2 * settled)])
    noise = lfilter(b, a, rng.standard_normal((settled + shape[0], *shape[1:])), axis=0)[settled:]
    return sd_m / np.linalg.norm(impulse) * noise


def occlusions(
    frames: int, markers: int, fraction: float, rng: np.random.Generator, streak: int = OCCLUSION_FRAMES
) -> np.ndarray:
    """(T, M) where markers are hidden: streaks of some frames until the fraction is reached.

    Args:
        frames: Number of frames T.
        markers: Number of markers M.
        fraction: Part of the samples that is hidden, 0…1.
        rng: Source of the streaks.
        streak: Frames of a streak.

    Raises:
        InvalidInput: The fraction is no part of the samples.
        NotConverged: The streaks did not reach it.
    """
    if not 0.0 <= fraction <= 1.0:
        raise InvalidInput(f"the hidden fraction must be between 0 and 1, got {fraction:g}")
    hidden = np.zeros((frames, markers), dtype=bool)
    streak, wanted = min(streak, frames), round(fraction * hidden.size)
    for _ in range(MOST_STREAKS * hidden.size):
        if hidden.sum() >= wanted:
            break
        first, marker = rng.integers(1 - streak, frames), rng.integers(markers)
        hidden[max(first, 0) : first + streak, marker] = True
    if hidden.sum() < wanted:
        raise NotConverged(
            f"{int(hidden.sum())} of {wanted} samples are hidden after all streaks; hide fewer"
        )
    return hidden


def ghosts(positions: Array, count: int, rate_hz: float, rng: np.random.Generator) -> Array:
    """(T, count, 3) reflections that come and go near the body, m; NaN while absent.

    Args:
        positions: (T, M, 3) marker positions, m.
        count: Greatest number of reflections at a time.
        rate_hz: Frames per second.
        rng: Source of places and times.
    """
    frames = len(positions)
    found = np.full((frames, count, 3), np.nan)
    times = np.arange(frames) / rate_hz
    for ghost in range(count):
        at = int(rng.uniform(0, 0.5) * rate_hz)
        while at < frames:
            end = min(frames, at + max(2, int(rng.uniform(*GHOST_SECONDS) * rate_hz)))
            near = positions[at:end, rng.integers(positions.shape[1])]
            away = rng.normal(size=3)
            away *= rng.uniform(0.08, 0.35) / np.linalg.norm(away)
            drift = rng.normal(0, 0.1, 3) * (times[at:end, None] - times[at])
            found[at:end, ghost] = near + away + drift
            at = end + int(rng.uniform(0.2, 1.0) * rate_hz)
    return found


def without_labels(positions: Array, rng: np.random.Generator) -> Array:
    """(T, N, 3) the same points in a new random order in every frame, those present first."""
    shuffled = np.full_like(positions, np.nan)
    for k, points in enumerate(positions):
        seen = points[~np.isnan(points).any(axis=1)]
        shuffled[k, : len(seen)] = rng.permutation(seen)
    return shuffled
