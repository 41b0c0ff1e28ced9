"""Names of a whole limb that a trial exchanges with the other side's, found by following the trial.

Distances within a limb do not show such an exchange, and those to the trunk explain it by pairs that are not exchanged.
Poses do: a filter that watches limbs (:mod:`mbkf.filters.limb_watch`) finds the names under which both limbs fit.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.estimate import Recording
from mbkf.filters.kinematic.filter import KinematicFilter
from mbkf.filters.kinematic.report import KinematicReport
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.kinematic.warm_start import WarmStart
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.filters.tracking_loop import TrackingLoop, followed
from mbkf.labelling.exchanges import Exchange
from mbkf.model.sides import mirrored
from mbkf.numerics.threads import single_threaded
from mbkf.sensors.limb_fit import LimbFits
from mbkf.sensors.marker_sensor import MarkerSensor

LEAST_PAIRS = 3
"""Fewer exchanged pairs are no limb's: distances find them frame by frame."""


def crosses(found: Sequence[Exchange], segments: Sequence[str]) -> bool:
    """True where an exchange concerns two segments, or the segment from which limbs hang, so that it may be a limb's.

    Args:
        found: The exchanges.
        segments: (M,) segment of each marker.
    """
    of = [(segments[one.a], segments[one.b]) for one in found]
    return any(a != b or mirrored(a) == a for a, b in of)


def exchanged_by_pose(
    positions_m: Array, sensor: MarkerSensor, noise_m: Array, dt_s: float
) -> tuple[Exchange, ...]:
    """Exchanges of names under which a kinematic filter followed the trial; empty where they are not a limb's.

    Args:
        positions_m: (T, M, 3) named trajectories, NaN where hidden.
        sensor: The markers on the body.
        noise_m: (M,) their noise, m.
        dt_s: Time between frames.
    """
    unobservable = ~sensor.model.supports[sensor.joint_ids].any(axis=0)
    kalman = KinematicFilter(sensor, noise_m, dt_s, unobservable, KinematicSettings())
    start = WarmStart(kalman, LimbFits(sensor, noise_m, unobservable))
    loop = TrackingLoop(TrackingFilter(KinematicReport(kalman), start))
    recording = Recording(positions_m, np.zeros((len(positions_m), 0, 6)), dt_s)
    every = np.arange(positions_m.shape[1])
    orders = np.tile(every, (len(positions_m), 1))
    with single_threaded():
        for t, _, _ in followed(loop, recording):
            if loop.watch is not None and loop.watch.order is not None:
                orders[t] = loop.watch.order
    pairs = {
        (int(m), int(order[m])) for order in np.unique(orders, axis=0) for m in np.flatnonzero(order > every)
    }
    if len(pairs) < LEAST_PAIRS:
        return ()
    both = [(a, b, (orders[:, a] == b) & (orders[:, b] == a)) for a, b in sorted(pairs)]
    return tuple(Exchange(a, b, frames) for a, b, frames in both if frames.any())
