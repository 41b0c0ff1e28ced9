"""A reconstruction as rows to draw, packed small enough to travel inside a page."""

from __future__ import annotations

import base64
import zlib

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.errors import InvalidInput
from mbkf.io.contacts import bearing
from mbkf.io.results import PLOTTED, Reconstruction
from mbkf.model.human import HumanModel
from mbkf.model.segment_poses import segment_poses
from mbkf.viz.page import page
from mbkf.viz.scene.channels import Layout, marker_states
from mbkf.viz.scene.description import scene_description

MOST_HZ = 100.0
"""Faster recordings are shown with every second, third … frame."""

MISSING = 65535
"""Stands for NaN in packed rows."""


def playback_page(r: Reconstruction) -> str:
    """The page that plays a reconstruction: 3-D scene, plots, play, pause, speed, slider; it needs no server.

    Raises:
        InvalidInput: The result holds no frames.
    """
    return page(recording(r))


def recording(r: Reconstruction) -> dict[str, object]:
    """Data for a page that plays a reconstruction: ``scene`` and packed ``rows``.

    Raises:
        InvalidInput: The result holds no frames.
    """
    scene, rows, resolution = recorded_scene(r)
    return {"scene": scene, "rows": pack(rows, resolution)}


def recorded_scene(r: Reconstruction) -> tuple[dict[str, object], Array, Array]:
    """The parts of :func:`recording`.

    Returns:
        The scene's description (see :func:`mbkf.viz.scene.description.scene_description`) with the rows' rate,
        first time and the first row that shows the body (0 without one), the rows (T, width), and the resolution of
        each column (width,).

    Raises:
        InvalidInput: The result holds no frames.
    """
    if not r.frames:
        raise InvalidInput(f"the result of '{r.trial}' holds no frames to play")
    model = HumanModel.of(r.subject)
    supports = tuple(
        name for k, name in enumerate(r.support_names) if bearing(r.support_wrench[:, [k]]).any()
    )
    levels = r.level_names if r.trunk_moments is not None else ()
    layout = Layout(
        len(model.joints), len(r.marker_names), len(r.coordinate_names), supports=supports, levels=levels
    )
    stride = max(1, int(np.ceil(r.rate_hz / MOST_HZ - 1e-9)))
    shown = slice(None, None, stride)
    rows = _rows(r, model, layout, shown)
    corners = np.empty((0, 4, 3)) if r.plate_corners_m is None else r.plate_corners_m
    scene = scene_description(
        r.trial, model, r.marker_names, r.coordinate_names, corners, layout, streamed=False
    )
    timing = {
        "rate_hz": r.rate_hz / stride,
        "start_s": float(r.times_s[0]),
        "first_tracked": int(np.argmax(r.tracked[shown])),
    }
    return {**scene, **timing}, rows, layout.resolution()


def _rows(r: Reconstruction, model: HumanModel, layout: Layout, shown: slice) -> Array:
    frames = np.arange(r.frames)[shown]
    rows = layout.blank(len(frames))
    tracked = r.tracked[shown]
    blank = np.full(len(frames), np.nan)
    acts = _unexplained(r)[shown]
    status = np.column_stack(
        [r.times_s[shown], frames, 1e3 * r.step_seconds[shown], blank, blank, tracked, acts]
    )
    layout.put(rows, "status", status)
    layout.put(rows, "segments", segment_poses(model, np.where(tracked[:, None], r.q[shown], np.nan)))
    state = marker_states(r.measured_m, r.hidden, r.rejected)[shown]
    layout.put(rows, "measured", np.where(r.hidden[shown][:, :, None], np.nan, r.measured_m[shown]))
    layout.put(rows, "predicted", np.where(tracked[:, None, None], r.predicted_m[shown], np.nan))
    layout.put(rows, "state", state)
    loads = r.loads
    drawn = [loads.names.index(name) for name in layout.loads]
    layout.put(rows, "force", loads.wrench[shown][:, drawn, :3])
    layout.put(rows, "force_sd", loads.wrench_sd[shown][:, drawn, :3])
    layout.put(rows, "pressure", loads.point_m[shown][:, drawn])
    layout.put(rows, "source", loads.source[shown][:, drawn])
    for part in ("angles", "angles_sd", "moments", "moments_sd", *PLOTTED):
        values = getattr(r, part)
        if values is not None:
            layout.put(rows, part, values[shown])
    for part, moments in (("trunk", r.trunk_moments), ("trunk_sd", r.trunk_moments_sd)):
        if moments is not None:
            layout.put(rows, part, moments[shown])
    return rows


def _unexplained(r: Reconstruction) -> BoolArray:
    """(T,) frames in which an unexplained force acts."""
    found = np.zeros(r.frames, dtype=bool)
    for one in r.unexplained:
        found |= (r.times_s >= one.from_s) & (r.times_s <= one.to_s)
    return found


def pack(rows: Array, resolution: Array | float = 0.0) -> dict[str, object]:
    """Rows (T, W) as JSON can hold them: whole steps, differences in time, deflated.

    Args:
        rows: The rows.
        resolution: (W,) size of a step of each column; larger where a column's range has more than 65 534 of them.

    Returns:
        ``frames``, ``low`` and ``step`` (W,) of value = low + step · count, and ``data``: base64 of the deflated
        16-bit little-endian counts, column by column, each but the first as the difference from the one before
        (modulo 65 536). :data:`MISSING` stands for NaN.
    """
    rows = np.where(np.isfinite(rows), rows, np.nan)
    empty = np.isnan(rows).all(axis=0)
    low = np.where(empty, 0.0, np.nanmin(np.where(empty, 0.0, rows), axis=0))
    high = np.where(empty, 0.0, np.nanmax(np.where(empty, 0.0, rows), axis=0))
    step = np.maximum((high - low) / (MISSING - 1), resolution)
    step = np.where(step > 0.0, step, 1.0)
    counts = np.where(np.isnan(rows), MISSING, np.round((np.nan_to_num(rows) - low) / step))
    columns = np.ascontiguousarray(counts.T).astype(np.uint16)
    columns[:, 1:] -= columns[:, :-1].copy()
    data = base64.b64encode(zlib.compress(columns.astype("<u2").tobytes(), 9)).decode("ascii")
    return {"frames": len(rows), "low": _short(low), "step": _short(step), "data": data}


def _short(values: Array) -> list[float]:
    return [float(f"{value:.7g}") for value in values]
