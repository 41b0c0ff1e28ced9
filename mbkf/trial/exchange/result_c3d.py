"""A reconstruction as a C3D file: markers, angles, moments, powers, joint centres, reactions, plates and foot events.

Plates and analog channels are those of the trial that the result was made from, where that is given. Loads that no
plate reads stand in the file as plates that the filter estimates, one for each part of the body.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from mbkf.io.c3d_write import write_c3d
from mbkf.io.contacts import FEET
from mbkf.io.records import Capture, CaptureEvent, DerivedPoint, MarkerTrajectories
from mbkf.io.results import Reconstruction
from mbkf.model.human import HumanModel
from mbkf.trial.exchange.even_frames import at_rows, even_rows
from mbkf.trial.exchange.joint_points import derived_from_joints, joint_point_names, side_of
from mbkf.trial.exchange.result_plates import analog_of, plates_of
from mbkf.trial.gait.events import foot_events

FITTED = "_model"
"""Ends the names of markers on the reconstructed body."""

CENTRES = {"hip": "HJC", "knee": "KJC", "ankle": "AJC", "shoulder": "SJC", "elbow": "EJC", "wrist": "WJC"}
"""Plug-in Gait's names of joint centres, after the side; others are named after their joint."""

MOST_FRAMES = 2**31
"""Numbers of frames fit in two words of 16 bits; some readers take them with a sign."""

SIDE_WORDS = (("R", "Right"), ("L", "Left"))


def write_result_c3d(r: Reconstruction, path: str | Path, trial: Capture | None = None) -> None:
    """Writes a result as a C3D file.

    Args:
        r: The result.
        path: The file; its suffix is ``.c3d``.
        trial: The capture that the result was made from, for its plates and analog channels (:func:`trial_of`).

    Raises:
        InvalidInput: The suffix is another one, or the result has no frames.
        UnknownName: The subject's body is unknown.
        OSError: The file cannot be written.
    """
    write_c3d(result_capture(r, trial), path, every_channel=True)


def result_capture(r: Reconstruction, trial: Capture | None = None) -> Capture:
    """The measured markers as a capture, with everything that was computed as derived points, plates and channels.

    Frames that a live run lost are missing in all points, and so are derived points where the body is not followed.
    Points that are never known are left out.

    Args:
        r: The result.
        trial: The capture that it was made from.

    Raises:
        UnknownName: The subject's body is unknown.
    """
    model = HumanModel.of(r.subject)
    rows = even_rows(r.times_s, r.rate_hz)
    start_s = _start_s(r)
    markers = MarkerTrajectories(r.marker_names, at_rows(r.measured_m, rows), r.rate_hz, start_s)
    points = [
        *_fitted(r),
        *derived_from_joints(r, model),
        *_loads(r),
        *_places(r, model),
    ]
    shown = [replace(p, values=np.where(r.tracked[:, None], p.values, np.nan)) for p in points]
    known = [p for p in shown if np.isfinite(p.values).all(axis=1).any()]
    return Capture(
        path="",
        markers=markers,
        derived=tuple(replace(p, values=at_rows(p.values, rows)) for p in known),
        events=_events(r, start_s),
        subject_mass_kg=r.subject.mass_kg,
        plates=plates_of(r, rows, start_s, trial),
        analog=analog_of(markers, r, trial),
    )


def _fitted(r: Reconstruction) -> Iterator[DerivedPoint]:
    for k, name in enumerate(r.marker_names):
        description = f"marker {name} on the reconstructed body"
        yield DerivedPoint(name + FITTED, "point", r.predicted_m[:, k], "m", description)


def _loads(r: Reconstruction) -> Iterator[DerivedPoint]:
    """Forces on feet and other parts that ever bear load, and where they act."""
    loads = r.loads
    description = "force on the body in the laboratory's axes, Z+ up"
    for k, name in enumerate(loads.names):
        if k >= len(FEET) and not loads.source[:, k].any():
            continue
        part = "".join(word.capitalize() for word in name.split("_"))
        side = SIDE_WORDS[k][0] if k < len(FEET) else ""
        force = f"{side}GroundReactionForce" if side else f"{part}ContactForce"
        yield DerivedPoint(force, "force", loads.wrench[:, k, :3], "N", description)
        where = f"{side}CentreOfPressure" if side else f"{part}ContactPoint"
        yield DerivedPoint(where, "point", loads.point_m[:, k], "m", "where that force acts")


def _places(r: Reconstruction, model: HumanModel) -> Iterator[DerivedPoint]:
    """Joint centres and the body's centre of mass."""
    joints = [joint for joint in model.description.clinical_joints if joint.proximal != "world"]
    ids = [model.joint(joint.distal).joint_id for joint in joints]
    centres = np.full((r.frames, len(joints), 3), np.nan)
    mass_centre = np.full((r.frames, 3), np.nan)
    for t in np.flatnonzero(r.tracked):
        centres[t] = model.placements(r.q[t])[1][ids]
        mass_centre[t] = model.centre_of_mass(r.q[t])
    for k, joint in enumerate(joints):
        base, side = side_of(joint.name)
        name = f"{side}{CENTRES[base]}" if base in CENTRES else f"{joint_point_names(joint)[0]}JC"
        yield DerivedPoint(name, "point", centres[:, k], "m", f"centre of the joint {joint.name}")
    yield DerivedPoint("CentreOfMass", "point", mass_centre, "m", "of the whole body")


def _start_s(r: Reconstruction) -> float:
    """Time of the first frame as a C3D file can state it, by that frame's number; 0 where it is outside a trial."""
    if not r.frames:
        return 0.0
    number = round(float(r.times_s[0]) * r.rate_hz)
    return number / r.rate_hz if 0 <= number < MOST_FRAMES else 0.0


def _events(r: Reconstruction, start_s: float) -> tuple[CaptureEvent, ...]:
    """Strikes and offs of both feet, in order of time, where the first frame is at another time."""
    later_s = start_s - float(r.times_s[0]) if r.frames else 0.0
    return tuple(CaptureEvent(label, side, time_s + later_s) for time_s, label, side in foot_instants(r))


def foot_instants(r: Reconstruction) -> list[tuple[float, str, str]]:
    """Time in s, label and side of the strikes and offs of both feet, in order of time."""
    found = [
        (float(time_s), label, side)
        for (_, side), foot in zip(SIDE_WORDS, foot_events(r), strict=True)
        for label, times_s in (("Foot Strike", foot.strikes_s), ("Foot Off", foot.offs_s))
        for time_s in times_s
    ]
    return sorted(found, key=lambda one: one[0])
