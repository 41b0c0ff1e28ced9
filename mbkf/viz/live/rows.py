"""Frames of a live reconstruction as rows to draw: clinical angles and torques with their spreads, poses, markers."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.io.contacts import Source, bearing
from mbkf.io.result_groups import SupportLoads
from mbkf.model.body import Body
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.segment_poses import segment_poses
from mbkf.sensors.contact.plates import pressure_and_free_moment
from mbkf.sensors.supports.bearings import BearingParts
from mbkf.stream.results.frame import LiveFrame
from mbkf.trial.results.supports import pressed_points, support_loads
from mbkf.viz.scene.channels import Layout, marker_states

MOST_UNLABELLED = 60
"""Points without a name that are drawn at most."""

PRESSURE_FROM_N = 20.0
"""Vertical force from which a reaction is drawn."""


class DisplayRows:
    """Turns frames into rows, one after another.

    Attributes:
        clinical: The coordinates shown.
        layout: Of the rows.
    """

    def __init__(self, model: Body, markers: int, surface_m: float = 0.0) -> None:
        """Rows of a body.

        Args:
            model: The scaled body.
            markers: Number of markers.
            surface_m: Height of the surface that centres of pressure lie on, m.
        """
        self.clinical = ClinicalAngles(model)
        self._bearings, coordinates = BearingParts(model), len(self.clinical.names)
        self.layout = Layout(len(model.joints), markers, coordinates, MOST_UNLABELLED, self._bearings.names)
        self._model, self._surface_m = model, surface_m
        self._before: Array | None = None

    def row(self, frame: LiveFrame) -> Array:
        """(width,) the row of a frame.

        Angles stay continuous with the row before.
        """
        put, rows = self.layout.put, self.layout.blank(1)
        status = (
            frame.time_s, frame.number, 1e3 * frame.latency_s, frame.rate_hz, frame.lost, frame.tracked,
            frame.unexplained,
        )  # fmt: skip
        put(rows, "status", np.array([status], dtype=float))
        measured = frame.measured_m
        put(rows, "measured", measured[None])
        nowhere = np.zeros(len(measured), dtype=bool)
        put(rows, "state", marker_states(measured, nowhere, nowhere)[None])
        if frame.tracked and np.isfinite(frame.q).all():
            put(rows, "predicted", frame.predicted_m[None])
            put(rows, "segments", segment_poses(self._model, frame.q[None]))
            self._put_curves(rows, frame)
        self._put_reactions(rows, frame)
        for name, values in frame.plotted.items():
            put(rows, name, values[None])
        first, _ = self.layout.parts["unlabelled"]
        points = frame.unlabelled_m[:MOST_UNLABELLED].ravel()
        rows[0, first : first + len(points)] = points
        row: Array = rows[0]
        return row

    def _put_curves(self, rows: Array, frame: LiveFrame) -> None:
        q = frame.q[None]
        angles = self.clinical.angles(q, self._before)
        self._before = angles[0]
        self.layout.put(rows, "angles", angles)
        self.layout.put(rows, "angles_sd", frame.angle_sd[None])
        self.layout.put(rows, "moments", self.clinical.moments(q, frame.torques[None], angles))
        self.layout.put(rows, "moments_sd", self.clinical.moments_sd(q, frame.torques_sd[None], angles))

    def _put_reactions(self, rows: Array, frame: LiveFrame) -> None:
        pressure, _ = pressure_and_free_moment(frame.wrench[None], self._surface_m, PRESSURE_FROM_N)
        parts = self._parts(frame)
        bears = bearing(parts.support_wrench)[0]
        for part, feet, others in (
            ("force", frame.wrench[:, :3], parts.support_wrench[0, :, :3]),
            ("force_sd", frame.wrench_sd[:, :3], parts.support_wrench_sd[0, :, :3]),
            ("pressure", pressure[0], parts.support_point_m[0]),
            ("source", frame.foot_source, np.where(bears, Source.ESTIMATED, Source.NONE)),
        ):
            self.layout.put(rows, part, np.concatenate([feet, others])[None])

    def _parts(self, frame: LiveFrame) -> SupportLoads:
        """Loads on other parts than the feet; NaN where the filter does not ask."""
        names = self._bearings.names
        if not names or len(frame.support) != len(names) or not np.isfinite(frame.q).all():
            return support_loads(names, np.full((1, len(names), 6), np.nan))
        points = pressed_points(self._bearings, frame.q, frame.support)
        return support_loads(names, frame.support[None], frame.support_sd[None], points[None])
