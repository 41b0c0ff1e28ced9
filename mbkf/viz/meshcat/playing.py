"""A result in MeshCat as an animation: the body, the markers and the loads on the body."""

from __future__ import annotations

from collections.abc import Iterator

import meshcat
import numpy as np
from meshcat import geometry as shapes
from meshcat.animation import Animation, AnimationClip, AnimationTrack
from meshcat.path import Path
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.errors import InvalidInput
from mbkf.io.results import Reconstruction
from mbkf.model.body_shapes import MARKER_COLOUR, MARKER_RADIUS_M, side_of
from mbkf.model.geometry_model import MARKER_PREFIX, geometry_model
from mbkf.model.human import HumanModel
from mbkf.model.segment_poses import segment_poses
from mbkf.viz.meshcat.visualiser import BodyVisualiser, body_visualiser, opened

MOST_HZ = 50.0
"""Faster results are shown with every second, third … frame; MeshCat interpolates between frames."""

WEIGHTS_PER_M = 1.1
"""Body weights for a metre of an arrow, as on mbkf's own page."""

LEAST_M = 0.02
"""Shorter arrows are hidden."""

SHAFT_M, HEAD_M, HEAD_RADIUS_M = 0.011, 0.09, 0.032
"""Radius of an arrow's shaft, length and radius of its head."""

ARROW_COLOURS = {"right": 0x0072B2, "left": 0xD55E00, "": 0x37424F}
"""Colours of arrows by side (mbkf/viz/assets/colours.js)."""

OPPOSITE = 1e-9
"""Size of an unnormalised quaternion below which a direction counts as opposite to y."""

LOADS, MARKERS = "loads", "markers"
"""Nodes of the scene that hold arrows and markers."""


def play(
    result: Reconstruction,
    speed: float = 1.0,
    *,
    open: bool | None = None,
    viewer: meshcat.Visualizer | None = None,
) -> BodyVisualiser:
    """Plays a result in MeshCat's 3-D viewer: body, measured markers, and loads on feet and other parts as arrows.

    The viewer's *Animations* menu plays, pauses and seeks. Body, markers and arrows are hidden in frames in which they
    are not known. An arrow of 1 m is 1.1 body weights long.

    Args:
        result: The result, e.g. of :func:`mbkf.reconstruct` or :func:`mbkf.read_reconstruction`.
        speed: Seconds of the movement that pass in a second.
        open: True opens the page in a browser, False does not; by default it opens outside notebooks.
        viewer: The MeshCat viewer to draw into; a new one, with a server on this computer, by default.

    Returns:
        Pinocchio's visualiser, which a notebook displays; it shows the first tracked frame until the animation plays.

    Raises:
        InvalidInput: The body is tracked in no frame, or the speed is not positive.
        UnknownName: The subject's body does not exist.
    """
    if not (np.isfinite(speed) and speed > 0.0):
        raise InvalidInput(f"speed must be a positive number, not {speed}")
    if not result.tracked.any():
        raise InvalidInput(
            f"the body is tracked in 0 of {result.frames} frames of '{result.trial}', so that no frame can be shown; "
            "its warnings name the cause"
        )
    model = HumanModel.of(result.subject)
    shown = body_visualiser(model, geometry_model(model), viewer)
    scene = shown.viewer[model.description.name]
    _place_markers(scene[MARKERS], result)
    _place_arrows(scene[LOADS], result)
    shown.display(result.q[int(np.argmax(result.tracked))])
    shown.look_at(result.q[result.tracked, :3].mean(axis=0))
    shown.viewer.set_animation(animation(result, model, shown, speed))
    return opened(shown, open)


def animation(result: Reconstruction, model: HumanModel, shown: BodyVisualiser, speed: float) -> Animation:
    """The result's movement as keys of MeshCat's nodes.

    Args:
        result: The result.
        model: The subject's body.
        shown: The visualiser whose nodes move.
        speed: Seconds of the movement that pass in a second.
    """
    stride = max(1, int(np.ceil(result.rate_hz / MOST_HZ - 1e-9)))
    rows = np.arange(0, result.frames, stride)
    keys = _Keys(result.times_s[rows] - result.times_s[rows[0]], speed)
    root = shown.viewer[model.description.name]
    tracked = result.tracked[rows]
    poses = segment_poses(model, np.where(tracked[:, None], result.q[rows], np.nan))
    for k, name in enumerate(model.joints):
        path = shown.viewer[f"{shown.viewerVisualGroupName}/{name}"].path
        keys.move(path, poses[:, k, :3], poses[:, k, 3:])
    for k, name in enumerate(result.marker_names):
        seen = np.where(result.hidden[rows, k, None], np.nan, result.measured_m[rows, k])
        keys.move(root[MARKERS][MARKER_PREFIX + name].path, seen)
    for name, points_m, turns, lengths_m in _arrows(result, rows):
        path = root[LOADS][name].path
        keys.move(path, points_m, turns)
        tip = np.minimum(HEAD_M, 0.5 * lengths_m)
        keys.add(path.append("shaft"), "scale", "vector3", _along_y(lengths_m - tip, 1.0))
        keys.add(path.append("head"), "position", "vector3", _along_y(lengths_m - tip, 0.0))
        keys.add(path.append("head"), "scale", "vector3", np.tile(tip[:, None] / HEAD_M, 3))
    return Animation(keys.clips)


class _Keys:
    """Clips of an animation by path; a key of each property for each known time."""

    def __init__(self, times_s: Array, speed: float) -> None:
        self.clips: dict[Path, AnimationClip] = {}
        self._times_s, self._speed = times_s, speed

    def move(self, path: Path, position_m: Array, quaternion: Array | None = None) -> None:
        """Positions (T, 3) and quaternions (T, 4); the node is visible where they are known."""
        self._known(path, np.asarray(np.isfinite(position_m).all(axis=1)))
        self.add(path, "position", "vector3", position_m)
        if quaternion is not None:
            self.add(path, "quaternion", "quaternion", quaternion)

    def add(self, path: Path, name: str, kind: str, values: Array) -> None:
        """A property (T, n) by its name and type in three.js; frames with NaN have no key."""
        known = np.flatnonzero(~np.isnan(values).any(axis=1))
        self._track(path, name, kind, known, values[known].tolist())

    def _known(self, path: Path, known: BoolArray) -> None:
        if not known.all():
            changes = np.flatnonzero(np.diff(known, prepend=~known[:1]))
            self._track(path, "visible", "boolean", changes, known[changes].tolist())

    def _track(self, path: Path, name: str, kind: str, rows: NDArray[np.int64], values: list[object]) -> None:
        if len(rows):
            clip = self.clips.setdefault(path, AnimationClip(fps=self._speed))
            clip.tracks[name] = AnimationTrack(name, kind, self._times_s[rows].tolist(), values)


def _along_y(values: Array, others: float) -> Array:
    """(T, 3) the values along y, and another number along x and z."""
    found = np.full((len(values), 3), others)
    found[:, 1] = values
    return np.where(np.isnan(values)[:, None], np.nan, found)


def _arrows(result: Reconstruction, rows: NDArray[np.int64]) -> Iterator[tuple[str, Array, Array, Array]]:
    """Of each part that bears load: name, points (T, 3), quaternions (T, 4) and lengths (T,); NaN without a load."""
    loads = result.loads
    scale = 1.0 / (WEIGHTS_PER_M * result.subject.mass_kg * GRAVITY_M_S2)
    for k, name in enumerate(loads.names):
        force, points = loads.wrench[rows, k, :3], loads.point_m[rows, k]
        lengths = scale * np.linalg.norm(force, axis=1)
        acts = (lengths > LEAST_M) & ~np.isnan(points).any(axis=1)
        if acts.any():
            lengths = np.where(acts, lengths, np.nan)
            turns = np.full((len(rows), 4), np.nan)
            turns[acts] = _turned_to(force[acts])
            yield name, np.where(acts[:, None], points, np.nan), turns, lengths


def _turned_to(directions: Array) -> Array:
    """(T, 4) quaternions (x, y, z, w) of the shortest turns from y to these directions; to −y about x."""
    unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    y = np.array([0.0, 1.0, 0.0])
    turns = np.column_stack([np.cross(y, unit), 1.0 + unit @ y])
    turns[np.linalg.norm(turns, axis=1) < OPPOSITE] = [1.0, 0.0, 0.0, 0.0]
    return Rotation.from_quat(turns).as_quat()


def _place_markers(node: meshcat.Visualizer, result: Reconstruction) -> None:
    ball, paint = (
        shapes.Sphere(MARKER_RADIUS_M),
        shapes.MeshLambertMaterial(color=_hexadecimal(MARKER_COLOUR)),
    )
    for name in result.marker_names:
        node[MARKER_PREFIX + name].set_object(ball, paint)


def _place_arrows(node: meshcat.Visualizer, result: Reconstruction) -> None:
    shaft = shapes.Cylinder(1.0, SHAFT_M)
    head = shapes.Cylinder(HEAD_M, radiusTop=0.0, radiusBottom=HEAD_RADIUS_M)
    for name, *_ in _arrows(result, np.arange(result.frames)):
        paint = shapes.MeshLambertMaterial(color=ARROW_COLOURS[side_of(name)])
        node[name]["shaft"]["bar"].set_object(shaft, paint)
        node[name]["shaft"]["bar"].set_transform(_raised(0.5))
        node[name]["head"]["cone"].set_object(head, paint)
        node[name]["head"]["cone"].set_transform(_raised(0.5 * HEAD_M))


def _raised(by_m: float) -> Array:
    place = np.eye(4)
    place[1, 3] = by_m
    return place


def _hexadecimal(colour: tuple[float, float, float]) -> int:
    red, green, blue = (round(255 * part) for part in colour)
    return (red << 16) + (green << 8) + blue
