"""A subject's markers on the body: fixed to their segments, or on skin that moves with the joints.

A marker whose displacements c_d by flexion are known is at p + Σ_d f(θ_d) c_d in the frame of its segment
(:mod:`mbkf.sensors.flexed_skin`). The displacement at a configuration is a known shift of the measurement there; its
small derivative by the configuration is left out of the Jacobian. On persons with exact truth the estimates with and
without that derivative are the same.

A marker that was corrected on a trial stays at its place in the usual posture of that trial.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.io.subject import SubjectMarker
from mbkf.model.body import Body
from mbkf.sensors.flexed_skin import FlexedSkin
from mbkf.sensors.marker_sensor import MarkerReading, MarkerSensor


class FlexedMarkerSensor(MarkerSensor):
    """Markers on skin that moves with flexion: m = r_b + A_b (p + Σ_d f(θ_d(q)) c_d)."""

    def __init__(
        self, model: Body, segments: Sequence[str], neutral_m: Array, slides_m: Sequence[Array]
    ) -> None:
        """Prepares the displacements.

        Args:
            model: The body.
            segments: Segment of each of the M markers.
            neutral_m: (M, 3) positions in the segments' frames in the neutral posture, m.
            slides_m: By marker its displacements by flexion, (D, 3) m; no rows for one without any.
        """
        super().__init__(model, segments, neutral_m)
        skin = FlexedSkin(model, self.segments)
        slides = np.zeros((len(self.segments), skin.flexions, 3))
        for own, found in zip(slides, slides_m, strict=True):
            known = min(len(own), len(found))
            own[:known] = found[:known]
        self._displacement = skin.displacement(slides)

    def local_at(self, q: Array) -> Array:
        """(M, 3) positions in the segments' frames at q (nq,), m."""
        return self.local_m + self._displacement.at(q)

    def positions(self, q: Array) -> Array:
        """(M, 3) world positions at the configuration q (nq,)."""
        if self.compiled is not None:
            return self.compiled.places(q, self.local_at(q))[0]
        return self.weights(self.local_at(q)) @ self.model.frames(q)

    def reading(self, q: Array) -> MarkerReading:
        """Positions and their Jacobian at q (nq,), displacements held."""
        if self.compiled is not None:
            return self.reading_of(*self.compiled.places(q, self.local_at(q)))
        frames, jacobian = self.model.frames_and_jacobian(q)
        return self.reading_of(self.weights(self.local_at(q)) @ frames, jacobian)


def subject_sensor(model: Body, markers: Sequence[SubjectMarker]) -> MarkerSensor:
    """A subject's markers on the body, at places that follow the posture where their displacements are known.

    Args:
        model: The subject's body.
        markers: The M markers.
    """
    segments = [marker.segment for marker in markers]
    places = np.array([marker.position_m for marker in markers]).reshape(-1, 3)
    slides = [marker.free_slides_m for marker in markers]
    if not any(own.any() for own in slides):
        return MarkerSensor(model, segments, places)
    return FlexedMarkerSensor(model, segments, places, slides)
