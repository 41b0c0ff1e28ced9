"""Two models of skin that moves over bone, neither of which has the form that a filter could assume.

Both give displacements of markers in the axes of the bodies that they are on, zero in the standing posture. Amplitudes
are root mean squares over a person's movements, of the size that skin studies report:

- thigh 12 mm, shank 6 mm: bone pins and fluoroscopy (C. Reinschmidt et al., J. Biomech. 30 (1997) 729-732;
  M. Akbarshahi et al., J. Biomech. 43 (2010) 1292-1301; A. Barré et al., IEEE Trans. Biomed. Eng. 60 (2013) 3131-3140;
  A. Ancillao et al., Hum. Mov. Sci. 80 (2021) 102866: clusters of thigh and shank by 18 and 17 mm and 10° and 7°,
  single markers by 4 to 16 mm);
- pelvis 6 mm, hip rotation missed by up to 22°: dual fluoroscopy (N. M. Fiorentino et al., Gait Posture 55 (2017)
  184-190: ranges from 3 to 54 mm over markers and activities);
- trunk 7 mm: upright MRI (R. Zemp et al., PLoS ONE 9 (2014) e95426: 9 to 11 mm from extended to flexed);
- upper arm 8 mm, its turn missed by up to 30°: bone pins (D. Hamming et al., J. Biomech. 45 (2012) 1161-1168).

Translation and rotation of whole clusters carry most of it, driven by the neighbouring joints (V. Camomilla et al.,
J. Biomech. 62 (2017) 5-13; A. Barré et al., J. Biomech. 62 (2017) 21-26); so it is here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array

AMPLITUDE_MM: Mapping[str, float] = {
    "pelvis": 6.0, "torso": 7.0, "femur": 12.0, "tibia": 6.0, "calcn": 2.5, "toes": 2.5, "humerus": 8.0, "ulna": 4.0,
    "radius": 4.0,
}  # fmt: skip
"""RMS over a person's movements by body."""

LARGEST_MM = 55.0
"""The largest displacement that was reported; larger ones are bent back to it."""

SLIDING, FIELDS = "sliding", "fields"
MODELS = (SLIDING, FIELDS)

LAG_S = 0.06
"""Time by which skin follows the joint."""

SATURATES_RAD = np.deg2rad(50.0)
WOBBLE_HZ, WOBBLE_DAMPING = {"femur": 6.5, "tibia": 11.0, "torso": 9.0, "humerus": 8.0, "pelvis": 9.0}, 0.25
LAG_OF_TURN = {"femur": 0.25, "humerus": 0.35, "tibia": 0.12}
"""Share of a bone's turn about its long axis that its skin does not follow."""

MODES = 24
"""Waves of a random field."""

SLOW_MM = 0.8
"""RMS of slow movement that depends on no joint."""


@dataclass(frozen=True)
class Driven:
    """Movement of one body that displaces its skin.

    Attributes:
        flexions: (T, d) flexion of neighbouring joints less standing, rad.
        others: (T, e) their other angles less standing, rad.
        turn: (T,) turn about the body's long axis less standing, rad.
        shock: (T, 3) acceleration of the body in its own axes, less its mean, m/s².
    """

    flexions: Array
    others: Array
    turn: Array
    shock: Array


def amplitude_m(body: str) -> float:
    """RMS displacement of a body's skin.

    Args:
        body: Its name, with or without side.
    """
    return 1e-3 * AMPLITUDE_MM[body.split("_", maxsplit=1)[0]]


def lagged(values: Array, dt_s: float, lag_s: float = LAG_S) -> Array:
    """(T, …) values as a first-order lag follows them, from rest at the first one.

    Args:
        values: (T, …) values.
        dt_s: Time between samples.
        lag_s: Time constant.
    """
    share = 1.0 - np.exp(-dt_s / lag_s)
    found = np.array(values, dtype=float)
    for t in range(1, len(found)):
        found[t] = found[t - 1] + share * (values[t] - found[t - 1])
    return found


def wobble(shock: Array, dt_s: float, frequency_hz: float, damping: float = WOBBLE_DAMPING) -> Array:
    """(T, …) displacement of a damped oscillator on a base with an acceleration, from rest.

    Args:
        shock: (T, …) acceleration of the base.
        dt_s: Time between samples.
        frequency_hz: Natural frequency.
        damping: Damping ratio.
    """
    omega, fine = 2.0 * np.pi * frequency_hz, 5
    place, speed = np.zeros(shock.shape[1:]), np.zeros(shock.shape[1:])
    found = np.zeros(shock.shape)
    for t in range(1, len(shock)):
        for k in range(fine):
            pull = shock[t - 1] + (shock[t] - shock[t - 1]) * k / fine
            speed = speed + dt_s / fine * (-pull - 2.0 * damping * omega * speed - omega**2 * place)
            place = place + dt_s / fine * speed
        found[t] = place
    return found


def sliding(body: str, places_m: Array, rng: np.random.Generator) -> Callable[[Driven, float], Array]:
    """Skin that slides with a lag and stops at its limit, turns less than the bone, and wobbles after impacts.

    Args:
        body: The body.
        places_m: (M, 3) markers on it, m.
        rng: Draws directions.

    Returns:
        A function of what drives the skin and the time between samples, with (T, M, 3) displacements.
    """
    part, size, count = body.split("_", maxsplit=1)[0], amplitude_m(body), len(places_m)
    common = rng.normal(size=(10, 3)) * (0.6, 1.0, 0.5)
    own = 0.45 * rng.normal(size=(10, count, 3))
    middle = places_m.mean(axis=0)

    def moved(driven: Driven, dt_s: float) -> Array:
        late = lagged(driven.flexions, dt_s)
        with_lag = 0.7 * driven.flexions + 0.3 * late
        slid = np.tanh(with_lag / SATURATES_RAD)
        across = np.tanh(lagged(driven.others, dt_s) / np.deg2rad(25.0)) * 0.5
        drives = np.column_stack([slid, across])[:, :10]
        directions = common[: drives.shape[1], None] + own[: drives.shape[1]]
        found = size * np.einsum("td,dmi->tmi", drives, directions)
        turn = -LAG_OF_TURN.get(part, 0.0) * driven.turn
        lever = places_m - middle
        found[:, :, 0] += turn[:, None] * lever[:, 2]
        found[:, :, 2] -= turn[:, None] * lever[:, 0]
        if part in WOBBLE_HZ:
            found += wobble(driven.shock, dt_s, WOBBLE_HZ[part])[:, None] * (1.0 + 0.3 * own[0])
        return found

    return moved


def fields(body: str, places_m: Array, rng: np.random.Generator) -> Callable[[Driven, float], Array]:
    """Skin whose cluster moves, turns and stretches as random smooth functions of all neighbouring joint angles.

    Args:
        body: The body.
        places_m: (M, 3) markers on it, m.
        rng: Draws the functions.

    Returns:
        A function of what drives the skin and the time between samples, with (T, M, 3) displacements.
    """
    size, count = amplitude_m(body), len(places_m)
    lever = places_m - places_m.mean(axis=0)
    reach = max(float(np.sqrt((lever**2).sum(axis=1).mean())), 0.03)
    shapes = _cluster_modes(lever, reach)
    weights = np.concatenate([np.full(3, 0.75), np.full(3, 0.55), np.full(3, 0.25)])
    waves = rng.normal(size=(16, MODES))
    phases = rng.uniform(0.0, 2.0 * np.pi, MODES)
    rigid = rng.normal(size=(MODES, 9)) * weights
    alone = 0.35 * rng.normal(size=(MODES, count, 3))
    seed = int(rng.integers(2**31))

    def moved(driven: Driven, dt_s: float) -> Array:
        angles = np.column_stack(
            [
                driven.flexions / np.deg2rad(55.0),
                driven.others / np.deg2rad(25.0),
                driven.turn / np.deg2rad(25.0),
            ]
        )[:, :16]
        basis = np.cos(angles @ waves[: angles.shape[1]] + phases) - np.cos(phases)
        basis *= np.sqrt(2.0 / MODES)
        found = np.einsum("tk,kn,nmi->tmi", basis, rigid, shapes) + np.einsum("tk,kmi->tmi", basis, alone)
        return size * found + slow_noise(len(angles), count, dt_s, np.random.default_rng(seed))

    return moved


def _cluster_modes(lever: Array, reach_m: float) -> Array:
    """(9, M, 3) translations, turns and stretches of a cluster, each of unit size.

    Args:
        lever: (M, 3) places about the middle, m.
        reach_m: Their root mean square.
    """
    axes = np.eye(3)
    shifts = [np.repeat(axis[None], len(lever), axis=0) for axis in axes]
    turns = [np.cross(axis, lever) / reach_m for axis in axes]
    stretches = [lever * axis / reach_m for axis in axes]
    return np.array([*shifts, *turns, *stretches])


def slow_noise(frames: int, markers: int, dt_s: float, rng: np.random.Generator) -> Array:
    """(T, M, 3) smooth random movement over half a second, zero in the first frame.

    Args:
        frames: T.
        markers: M.
        dt_s: Time between frames.
        rng: Draws it.
    """
    width = max(1, round(0.25 / dt_s))
    kernel = np.hanning(2 * width + 1)
    raw = rng.normal(size=(frames + 2 * width, markers, 3))
    smooth = np.apply_along_axis(lambda one: np.convolve(one, kernel, "valid"), 0, raw)
    smooth *= 1e-3 * SLOW_MM / np.sqrt((kernel**2).sum())
    return np.asarray(smooth - smooth[0])


def bent_back(displacements_m: Array) -> Array:
    """(…, 3) displacements of at most :data:`LARGEST_MM`, the small ones as they are.

    Args:
        displacements_m: (…, 3) displacements.
    """
    size = np.linalg.norm(displacements_m, axis=-1, keepdims=True)
    most = 1e-3 * LARGEST_MM
    return np.asarray(displacements_m * most * np.tanh(size / most) / np.maximum(size, 1e-12))


def of_size(movements: Sequence[Array], size_m: float, sizing: int | None = None) -> list[Array]:
    """Displacements of several movements with this root mean square over all of them.

    Args:
        movements: (T, M, 3) displacements of each.
        size_m: Wanted root mean square of their norms.
        sizing: The root mean square is that of the first so many; None for all.
    """
    squares = np.concatenate([(one**2).sum(axis=2).ravel() for one in movements[:sizing]])
    now = float(np.sqrt(squares.mean()))
    factor = size_m / now if now > 0.0 else 0.0
    return [bent_back(factor * one) for one in movements]


MAKERS = {SLIDING: sliding, FIELDS: fields}
