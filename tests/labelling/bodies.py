"""A body with the reference markers, and frames of its points without labels."""

from dataclasses import dataclass

import numpy as np

from mbkf.labelling.assignment import HIDDEN
from mbkf.model.human import HumanModel
from mbkf.model.protocol import load_protocol
from mbkf.sensors.marker_sensor import MarkerSensor


@dataclass(frozen=True)
class Frame:
    """Points (N, 3) in random order and the point of every marker (M,), ``HIDDEN`` where it was taken away."""

    points: np.ndarray
    truth: np.ndarray


def reference_sensor(protocol="reference36"):
    model = HumanModel.scaled()
    markers = [m for m in load_protocol(protocol).markers if m.kind != "computed"]
    return MarkerSensor(model, [m.segment for m in markers], np.array([m.position_m for m in markers]))


def posture(model, rng, swing_rad=0.25, yaw=0.0):
    """A person standing somewhere, turned, with every joint a little off neutral."""
    turned = np.zeros(model.nv)
    turned[5] = yaw
    q = model.integrate(model.neutral(), turned)
    q[:3] += [*rng.uniform(-3.0, 3.0, 2), rng.uniform(0.8, 1.1)]
    step = np.zeros(model.nv)
    step[6:] = rng.uniform(-swing_rad, swing_rad, model.nv - 6)
    return model.integrate(q, step)


GHOSTS_CLEAR_M = 0.06
"""A ghost much nearer to a marker than this could as well be the marker."""


def unlabelled(positions, rng, missing=0, extra=0, noise_m=0.002):
    """The frame's points: some taken away, some ghosts added, all shuffled; no ghost beside a marker's place."""
    seen = np.ones(len(positions), dtype=bool)
    seen[rng.choice(len(positions), missing, replace=False)] = False
    ghosts = positions.mean(axis=0) + rng.uniform(-0.8, 0.8, (20 * extra, 3))
    ghosts = ghosts[np.linalg.norm(ghosts[:, None] - positions, axis=2).min(axis=1) > GHOSTS_CLEAR_M][:extra]
    points = np.concatenate([positions[seen] + rng.normal(0.0, noise_m, (seen.sum(), 3)), ghosts])
    order = rng.permutation(len(points))
    truth = np.full(len(positions), HIDDEN)
    truth[seen] = np.argsort(order)[: seen.sum()]
    return Frame(points[order], truth)
