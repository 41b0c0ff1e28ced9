"""Joints beside a segment without markers, in a chain whose other segments carry some.

Markers show such joints together only: hips and lumbar joint by where thighs and trunk are, hip and knee by pelvis
and shank are. Near a straight chain they hardly distinguish two ways of bending it, so that skin of some millimetres
decides. There the usual posture of people counts for more: a frame of markers on skin counts for 0.12 of an independent
reading (:class:`mbkf.sensors.markers.MarkerSettings`), and the posture prior beside it for a whole one, with
√0.12 = 0.35 times its own spreads. Errors of the pose by the person's body and posture take that weight into account
(:mod:`mbkf.filters.pose_errors`).
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.model.body import Body
from mbkf.sensors.marker_sensor import MarkerSensor

HOLE_POSTURE_SCALE = 0.35
"""Factor on the body's table of spreads beside a hole."""


def posture_scales(sensor: MarkerSensor, unobservable: BoolArray, usual: float = 1.0) -> Array:
    """(nv,) factors on the body's table of spreads of the posture.

    Args:
        sensor: The markers on the body.
        unobservable: (nv,) dofs that move no marker of the capture.
        usual: The factor away from holes.
    """
    return np.where(beside_holes(sensor, unobservable), HOLE_POSTURE_SCALE, usual)


def beside_holes(sensor: MarkerSensor, unobservable: BoolArray) -> BoolArray:
    """(nv,) dofs of joints on either side of a segment that carries no marker, while segments beyond it do.

    Args:
        sensor: The markers on the body.
        unobservable: (nv,) dofs that move no marker of the capture.
    """
    model = sensor.model
    holes = holes_of(model, frozenset(sensor.segments), unobservable)
    parents = {segment.name: segment.parent for segment in model.description.segments}
    found = np.zeros(model.nv, dtype=bool)
    for name, joint in model.joints.items():
        beside = name in holes or parents[name] in holes
        found[joint.v] = beside and joint.kind != "free" and not unobservable[joint.v].all()
    return found


def holes_of(model: Body, marked: frozenset[str], unobservable: BoolArray) -> frozenset[str]:
    """Segments without markers that move segments with some.

    A segment without a landmark, such as the neck, is never marked and no hole.

    Args:
        model: The body.
        marked: Segments that carry markers.
        unobservable: (nv,) dofs that move no marker of the capture.
    """
    bony = {landmark.segment for landmark in model.description.landmarks.values()}
    moving = {name for name, joint in model.joints.items() if not unobservable[joint.v].all()}
    return frozenset(bony & moving - marked)
