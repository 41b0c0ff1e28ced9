"""Two feet on one plate: each foot's share of its reading, with a standard deviation.

The plate reads the sum W of both wrenches about any point. In double support the foot ahead is loaded towards its heel
and the foot behind towards its toes; side by side both are loaded in the middle. With the expected centres of pressure
c_r, c_l and the plate's own p, the right foot carries the share

    s = (p − c_l) · (c_r − c_l) / |c_r − c_l|²,  0 ≤ s ≤ 1

of the vertical force F, known to √(s² + (1 − s)²) σ_c F / |c_r − c_l| with the spread σ_c of the centres along the line
between them. While the load passes from foot to foot, both centres roll forward by the same way, ρ (s − 1) and ρ s for
a right foot that is ahead, which leaves p = s c_r + (1 − s) c_l and so the share. The offset of p from the line moves
both of them. The force on each foot points to the pelvis, as in walking it passes near the centre of mass (Maus et al.,
Nature Communications 1:70, 2010); the rest of the measured shear is shared by the roots of the shares, so that a hardly
loaded foot takes none of it.

The constants below are set on two walks (biomechZoo HC032A, gaitalytics) and hold on four others (HC044A, Rajagopal's,
Rehazenter's, gait2354) and on a person who stands on two plates (Millard's): see ``python -m benchmarks contact``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, hypot
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.sensors.contact.plates import pressed_at
from mbkf.sensors.contact.soles import Sole

MIDDLE, FORWARD = 0.525, 0.275
"""Place along the sole, from heel 0 to toe end 1, at which a foot beside the other is loaded, and its shift when the
feet are a step apart: the foot ahead at the end of double support, the foot behind at its beginning."""

ROLL = 0.2
"""Way, in sole lengths, that the centres roll forward during double support when the feet are a step apart."""

STEP_M = 0.3
"""Distance ahead from which feet are a step apart."""

ALONG_SD_M, ACROSS_SD_M = 0.02, 0.009
"""Spread of a foot's expected centre of pressure along the feet and across them. Across, feet that bear alone and flat
are pressed 7 mm (RMS) beside the middle of the sole in six walkers, and the sole itself is known to about 5 mm."""

LEVER_M = 0.02
"""Spread of a foot's centre of pressure about the expected one, in the moments."""

LEAST_APART_M = 0.05
"""Least distance between the feet."""

LEAST_RISE_M = 0.1
"""Least height of the pelvis over a centre of pressure: lower, as for a person who lies down or a lost track, it gives
no direction of forces."""

SHEAR_SHARE, TWIST_M = 0.03, 0.01
"""Spread of a foot's shear force and of its free moment's arm, as shares of the plate's vertical force."""

LEAST_SHARE = 0.05
"""Least share of the plate's force by which the spreads of a foot are computed."""


PUSH_SHARE, PUSH_RISE_M = 0.8, 0.0125
"""Share of both feet's load on a foot that pushes off as its ball begins to rise, and the rise over which that falls to
its e-th part. Set on HC032A and the rajagopal walk; the shares of gaitalytics, HC044A, gait2354 (on a treadmill) and
Rehazenter's slow walk lie within a third of it."""

HEEL_OFF_M, PUSH_AFTER_S = 0.06, 0.15
"""A foot pushes off when its heel is higher than its ball by this, and it has stood for this long."""


@dataclass(frozen=True)
class SharedLoad:
    """A plate's reading shared between two feet.

    Attributes:
        wrench: (2, 6) force N and moment N m about the world's origin on right and left foot; they sum to the plate's.
        centres_m: (2, 3) expected centres of pressure.
        sd: (6,) spread of the right foot's wrench about its centre of pressure; the left one's is its opposite.
    """

    wrench: Array
    centres_m: Array
    sd: Array


class Stance(NamedTuple):
    """Where two feet are expected to be loaded.

    Attributes:
        centres_m: (2, 3) of right and left foot, the foot behind as it begins to be unloaded, the foot ahead as it
            ends to be loaded.
        roll_m: (2, 3) way of both centres meanwhile; backwards where the right foot is behind.
        forward: (2,) unit vector of the feet's mean heading.
    """

    centres_m: Array
    roll_m: Array
    forward: Array

    def centres_at(self, share: float) -> Array:
        """(2, 3) expected centres of pressure while the right foot carries this share of the load."""
        return np.asarray(self.centres_m + np.array([[share - 1.0], [share]]) * self.roll_m)


def push_share(sole: Sole, lowest_ball_m: float, stood_s: float) -> float | None:
    """Share of both feet's load on a foot that pushes off, None for one that does not.

    Args:
        sole: Heel, ball and toe end of its sole.
        lowest_ball_m: Least height of its ball while it has stood.
        stood_s: Duration for which it has stood.
    """
    heel, ball, _ = sole
    if heel[2] - ball[2] < HEEL_OFF_M or stood_s < PUSH_AFTER_S:
        return None
    return PUSH_SHARE * exp(-max(ball[2] - lowest_ball_m, 0.0) / PUSH_RISE_M)


def shear_to_pelvis(pelvis_m: Array, centres_m: Array) -> Array:
    """(k, 2) horizontal over vertical force that points from centres of pressure (k, 3) to the pelvis (3,)."""
    arms = pelvis_m - centres_m
    return np.asarray(arms[:, :2] / np.maximum(arms[:, 2:], LEAST_RISE_M))


def share_load(total: Array, soles: Sequence[Sole], pelvis_m: Array, surface_m: float) -> SharedLoad:
    """Shares a plate's reading between two feet.

    Args:
        total: (6,) force N and moment N m about the world's origin, with a vertical force other than zero.
        soles: Heel, ball and toe end of right and left sole.
        pelvis_m: (3,) point to which the forces point.
        surface_m: Height of the plate's surface.
    """
    force = float(total[2])
    pressed = np.array([*pressed_at(total.tolist(), surface_m), surface_m])
    stance = expected_stance(soles, surface_m)
    centres, forward = stance.centres_m, stance.forward
    line = centres[0] - centres[1]
    apart = max(float(np.linalg.norm(line)), LEAST_APART_M)
    share = min(max(0.5 + float((pressed - centres.mean(axis=0)) @ line) / apart**2, 0.0), 1.0)
    shares = np.array([share, 1.0 - share])
    centres = stance.centres_at(share)
    centres = centres + (pressed - shares @ centres)
    towards = (shares * force)[:, None] * shear_to_pelvis(pelvis_m, centres)
    left = np.outer(shares**0.5 / (shares**0.5).sum(), total[:2] - towards.sum(axis=0))
    forces = np.column_stack([towards + left, shares * force])
    moments = np.cross(centres, forces)
    moments[:, 2] += shares * (total[5] - moments[:, 2].sum())
    return SharedLoad(
        np.concatenate([forces, moments], axis=1), centres, _spread(share, force, line[:2], forward)
    )


def _spread(share: float, force_n: float, line_m: Array, forward: Array) -> Array:
    """(6,) spread of the right foot's wrench about its centre of pressure.

    Args:
        share: Its share of the vertical force.
        force_n: The vertical force of both feet.
        line_m: (2,) from the left foot's expected centre to the right one's.
        forward: (2,) heading of the feet.
    """
    apart = float(np.hypot(*line_m))
    along = float(line_m @ forward) / max(apart, 1e-9)
    centre = float(np.hypot(ALONG_SD_M * along, ACROSS_SD_M * (1.0 - along**2) ** 0.5))
    vertical = float(np.hypot(share, 1.0 - share)) * centre / max(apart, LEAST_APART_M)
    lever = LEVER_M * max(share, LEAST_SHARE)
    return force_n * np.array([SHEAR_SHARE, SHEAR_SHARE, vertical, lever, lever, TWIST_M])


def step_apart(stance: Stance) -> float:
    """Distance of the feet along their heading in steps: 0 side by side, 1 a step apart or more."""
    ahead = float((stance.centres_m[0] - stance.centres_m[1])[:2] @ stance.forward)
    return min(abs(ahead) / STEP_M, 1.0)


def push_apart(stance: Stance, pelvis_m: Array, vertical_n: Array) -> Array:
    """(2, 6) wrenches about the world's origin by which both feet push apart, as forces to the pelvis would.

    They lie on the line between the centres of pressure, so that their sum is zero: Newton's law cannot show them.

    Args:
        stance: Where the feet are expected to be loaded.
        pelvis_m: (3,) point to which the forces point.
        vertical_n: (2,) vertical forces on right and left foot, above 0.
    """
    centres = stance.centres_at(float(vertical_n[0] / vertical_n.sum()))
    line = (centres[0] - centres[1])[:2]
    right, left = shear_to_pelvis(pelvis_m, centres) * vertical_n[:, None]
    x, y = (line * (0.5 * float((right - left) @ line) / max(float(line @ line), LEAST_APART_M**2))).tolist()
    return np.array(
        [
            (fx, fy, 0.0, -cz * fy, cz * fx, cx * fy - cy * fx)
            for (cx, cy, cz), fx, fy in zip(centres.tolist(), (x, -x), (y, -y), strict=True)
        ]
    )


def expected_stance(soles: Sequence[Sole], surface_m: float) -> Stance:
    """Expected centres of pressure of right and left foot on a surface, from their places along the heading.

    Args:
        soles: Heel, ball and toe end of both soles.
        surface_m: Height of the surface.
    """
    along = [(toe[0] - heel[0], toe[1] - heel[1]) for heel, _, toe in soles]
    right, left = ((0.5 * (heel[0] + toe[0]), 0.5 * (heel[1] + toe[1])) for heel, _, toe in soles)
    x, y = along[0][0] + along[1][0], along[0][1] + along[1][1]
    length = max(hypot(x, y), 1e-9)
    x, y = x / length, y / length
    ahead = min(max(((right[0] - left[0]) * x + (right[1] - left[1]) * y) / STEP_M, -1.0), 1.0)
    places = MIDDLE - FORWARD * ahead, MIDDLE + FORWARD * ahead
    centres = [
        (heel[0] + place * way[0], heel[1] + place * way[1], surface_m)
        for (heel, _, _), place, way in zip(soles, places, along, strict=True)
    ]
    roll = [(ROLL * ahead * way[0], ROLL * ahead * way[1], 0.0) for way in along]
    return Stance(np.array(centres), np.array(roll), np.array([x, y]))
