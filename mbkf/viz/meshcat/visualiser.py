"""A person in MeshCat, drawn by Pinocchio's own visualiser."""

from __future__ import annotations

import contextlib
import io
import sys

import meshcat
import numpy as np
import pinocchio as pin
from pinocchio.visualize import MeshcatVisualizer

from mbkf.conventions import Array
from mbkf.errors import InvalidInput, ShapeError
from mbkf.io.subject import Subject, SubjectMarker
from mbkf.model.geometry_model import geometry_model
from mbkf.model.human import HumanModel

CELL_HEIGHT_PX = 480
"""Height of the viewer in a notebook."""

FROM_M = (2.0, -2.6, 1.1)
"""Place of the camera for a person at the origin."""

NEAR_M, DISTANCE_M, HIGHEST_M = 1.0, 3.2, 2.0
"""Persons within the first distance count as at the origin; the camera's distance from others, and its most height."""

BACKGROUND = {"top_color": (0.93, 0.95, 0.97), "bottom_color": (1.0, 1.0, 1.0)}
"""Colours of the sky and below, as on mbkf's own page."""

_NOTEBOOK = "ZMQInteractiveShell"
"""IPython's shell behind a notebook."""


class BodyVisualiser(MeshcatVisualizer):
    """Pinocchio's MeshCat visualiser of a body: ``display(q)`` poses it, and a notebook shows it as a cell's value.

    ``viewer`` is MeshCat's own visualiser: ``viewer.url()`` is the page's address, and ``viewer.static_html()`` the
    scene with its animation as a page of its own.

    Attributes:
        owned: True where the viewer was started for this body.
    """

    owned: bool = False

    def close(self) -> None:
        """Ends the viewer's server, which otherwise ends with Python; a viewer that was given stays open."""
        window = self.viewer.window
        server = getattr(window, "server_proc", None)
        if server is None or not self.owned:
            return
        window.zmq_socket.close(linger=0)
        server.kill()
        server.communicate()

    def look_at(self, point_m: Array) -> None:
        """Places the camera so that a person at a point (3,) in the world, m, is in the middle of the picture.

        MeshCat's camera always looks at the world's origin: it is placed on the line from there through the point.
        """
        x, y, z = camera_place(point_m)
        self.viewer["/Cameras/default/rotated/<object>"].set_property("position", [x, z, -y])

    def _repr_html_(self) -> str:
        """The viewer as a notebook's cell."""
        return str(self.viewer.jupyter_cell(height=CELL_HEIGHT_PX).data)


def show(
    subject: Subject | HumanModel,
    q: Array | None = None,
    *,
    open: bool | None = None,
    viewer: meshcat.Visualizer | None = None,
) -> BodyVisualiser:
    """Draws a person with the markers in MeshCat's 3-D viewer.

    Args:
        subject: The scaled person, or a body.
        q: (nq,) configuration; by default the posture of the static trial, else the neutral one on the floor.
        open: True opens the page in a browser, False does not; by default it opens outside notebooks.
        viewer: The MeshCat viewer to draw into; a new one, with a server on this computer, by default.

    Returns:
        Pinocchio's visualiser, which a notebook displays; ``display(q)`` poses the body anew.

    Raises:
        ShapeError: q does not have nq numbers.
        InvalidInput: q holds NaN or infinity.
        UnknownName: The subject's body, or the segment of a marker, does not exist.
    """
    model = subject if isinstance(subject, HumanModel) else HumanModel.of(subject)
    shown = body_visualiser(model, geometry_model(model, markers_of(subject)), viewer)
    q = _posture(subject, model, shown.visual_model) if q is None else _checked(q, model)
    shown.display(q)
    shown.look_at(model.centre_of_mass(q))
    return opened(shown, open)


def camera_place(point_m: Array) -> Array:
    """(3,) place from which a camera that looks at the origin sees a point (3,) in its middle, or a little above."""
    away = float(np.hypot(*point_m[:2]))
    if away < NEAR_M:
        return np.array(FROM_M)
    farther = (away + DISTANCE_M) / away
    return np.array([*(farther * point_m[:2]), np.clip(farther * point_m[2], 0.5 * HIGHEST_M, HIGHEST_M)])


def markers_of(subject: Subject | HumanModel) -> tuple[SubjectMarker, ...]:
    """The markers of a subject; a body has no markers."""
    return () if isinstance(subject, HumanModel) else subject.markers


def body_visualiser(
    model: HumanModel, geometry: pin.GeometryModel, viewer: meshcat.Visualizer | None
) -> BodyVisualiser:
    """A visualiser with the body's geometries loaded, not yet posed.

    Args:
        model: The scaled body.
        geometry: Its shapes (:func:`mbkf.model.geometry_model.geometry_model`).
        viewer: The MeshCat viewer to draw into; None starts one.
    """
    shown = BodyVisualiser(model.pin_model, pin.GeometryModel(), geometry)
    with contextlib.redirect_stdout(io.StringIO()):  # MeshCat prints its address
        shown.initViewer(viewer=viewer)
    shown.owned = viewer is None
    shown.loadViewerModel(model.description.name)
    for name, colour in BACKGROUND.items():
        shown.viewer["/Background"].set_property(name, colour)
    return shown


def opened(shown: BodyVisualiser, open_: bool | None) -> BodyVisualiser:
    """The visualiser, its page opened in a browser where that is asked for; None asks for it outside notebooks."""
    if not _in_notebook() if open_ is None else open_:
        shown.viewer.open()
    return shown


def _in_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    return type(shell).__name__ == _NOTEBOOK


def _checked(q: Array, model: HumanModel) -> Array:
    q = np.asarray(q, dtype=float)
    if q.shape != (model.nq,):
        raise ShapeError("q", f"({model.nq},)", q.shape)
    if not np.isfinite(q).all():
        raise InvalidInput("q holds NaN or infinity; give a frame in which the body is tracked")
    return q


def _posture(subject: Subject | HumanModel, model: HumanModel, geometry: pin.GeometryModel) -> Array:
    """The standing posture of the static trial, or the neutral one with its lowest point on the floor."""
    if isinstance(subject, Subject) and subject.standing_q is not None:
        return subject.standing_q
    q = model.neutral()
    origins = model.placements(q)[1]
    surfaces = [one for one in geometry.geometryObjects if one.name in model.joints]
    q[2] -= min(origins[one.parentJoint][2] + one.geometry.vertices()[:, 2].min() for one in surfaces)
    return q
