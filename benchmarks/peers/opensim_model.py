"""OpenSim's models of the captures' persons: scaled, and with markers placed on the static trial by its own tools."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.dynamic.captures import SOURCES
from benchmarks.peers.opensim_ik import Pose
from benchmarks.peers.required import opensim
from benchmarks.peers.shared import GAIT2354, RUN, WALK, to_opensim
from mbkf.conventions import Array
from mbkf.errors import NotConverged
from mbkf.io.capture import read_capture
from mbkf.io.records import MarkerTrajectories

RAJAGOPAL = Path("rajagopal_walk_run")
SCALED_WALK = RAJAGOPAL / "reference_walk" / "subject_walk_scaled.osim"
GAIT = Path("gait2354_walk") / "reference" / "subject01_simbody.osim"

_SIDE = {
    "{S}ASI": "{S}.ASIS", "{S}PSI": "{S}.PSIS", "{S}ACR": "{S}.Shoulder", "{S}LEL": "{S}.Elbow", "{S}MEL": "{S}.MElbow",
    "{S}LFC": "{S}.Knee", "{S}MFC": "{S}.MKnee", "{S}LMAL": "{S}.Ankle", "{S}MMAL": "{S}.MAnkle",
    "{S}CAL": "{S}.Heel", "{S}TOE": "{S}.Toe", "{S}MT5": "{S}.MT5",
}  # fmt: skip
SAME = {key.format(S=s): value.format(S=s) for s in "RL" for key, value in _SIDE.items()} | {
    "CLAV": "MidClavicle"
}
"""Markers of the run, and those of the walk's model that sit on the same landmark."""

_AT_JOINT = {
    "{S}HJC": "femur_{s}", "{S}KJC": "tibia_{s}", "{S}AJC": "talus_{s}", "{S}SJC": "humerus_{s}",
    "{S}EJC": "ulna_{s}", "{S}FAradius": "hand_{s}", "{S}FAulna": "hand_{s}",
}  # fmt: skip
AT_JOINT = {key.format(S=s): value.format(s=s.lower()) for s in "RL" for key, value in _AT_JOINT.items()}
"""Markers of the run at a joint's centre, and the body that has its origin there; wrists, about there."""

_ANYWHERE = {
    "{S}TH1": "femur_{s}", "{S}TH2": "femur_{s}", "{S}TH3": "femur_{s}",
    "{S}TB1": "tibia_{s}", "{S}TB2": "tibia_{s}", "{S}TB3": "tibia_{s}",
    "{S}UA1": "humerus_{s}", "{S}UA2": "humerus_{s}", "{S}UA3": "humerus_{s}", "{S}FAsuperior": "ulna_{s}",
    "{S}ASH": "torso", "{S}PSH": "torso",
}  # fmt: skip
ANYWHERE = {key.format(S=s): value.format(s=s.lower()) for s in "RL" for key, value in _ANYWHERE.items()} | {
    "C7": "torso"
}
"""Markers of the run on no landmark that the walk's model has: its marker placer finds where on their body they are."""

RUN_SETUP = RAJAGOPAL / "scale_setup_run.xml"

EVERY = 8
"""One frame of so many is used to correct markers."""


def write_model(name: str, data: Path, folder: Path) -> Path:
    """The model of a capture's person without muscles, as a file.

    Those of the walk and of gait2354 stand beside the capture. The run's is the walk's, scaled by OpenSim to the
    measurements of the setup beside the capture, and with markers placed on the static trial.

    Args:
        name: Name of the capture.
        data: Folder of the reference captures.
        folder: Where the model is written.
    """
    model = {WALK: _walk, RUN: _run, GAIT2354: _gait2354}[name](data, folder)
    path = folder / f"{name.replace(' ', '_')}.osim"
    model.finalizeConnections()
    model.printToXML(str(path))
    return path


def with_toes_held(model: Path) -> Path:
    """The same model with toes that do not bend, as a file beside it."""
    read = opensim().Model(str(model))
    for coordinate in read.getCoordinateSet():
        if "mtp" in coordinate.getName():
            coordinate.set_default_value(0.0)
            coordinate.set_locked(True)
    path = model.with_suffix(".toes_held.osim")
    read.finalizeConnections()
    read.printToXML(str(path))
    return path


def _gait2354(data: Path, _folder: Path) -> Any:
    return _without_muscles(data / GAIT)


def _walk(data: Path, _folder: Path) -> Any:
    return _without_muscles(data / SCALED_WALK)


def _run(data: Path, folder: Path) -> Any:
    model = _scaled(_with_markers_of_the_run(_walk(data, folder)), data, folder)
    weights = setup_weights(data / RUN_SETUP)
    known = {name: weight for name, weight in weights.items() if name not in ANYWHERE}
    place_markers(model, _static(RUN, data), known)
    return model


def _without_muscles(path: Path) -> Any:
    model = opensim().Model(str(path))
    model.updForceSet().clearAndDestroy()
    model.updControllerSet().clearAndDestroy()
    return model


def _static(name: str, data: Path) -> MarkerTrajectories:
    source = SOURCES[name]
    assert source.static is not None
    return read_capture(data / source.folder / source.static).markers


def _scaled(model: Any, data: Path, folder: Path) -> Any:
    """The model scaled by OpenSim's scale tool to the run's static trial; measurements between markers it has."""
    osim = opensim()
    start, setup, end = folder / "unscaled.osim", folder / "scale_run.xml", folder / "scaled.osim"
    model.finalizeConnections()
    model.printToXML(str(start))
    tree = ET.parse(data / RUN_SETUP)
    texts = {
        "GenericModelMaker/model_file": start.name,
        "ModelScaler/marker_file": os.path.relpath(data / RAJAGOPAL / "static_run.trc", folder),
        "ModelScaler/output_model_file": end.name,
        "ModelScaler/output_scale_file": "Unassigned",
        "MarkerPlacer/apply": "false",
    }
    for place, text in texts.items():
        (element,) = tree.findall(f"ScaleTool/{place}")
        element.text = text
    for objects in tree.iter("objects"):
        for pair in objects.findall("MarkerPair"):
            if not set((pair.findtext("markers") or "").split()).isdisjoint(ANYWHERE):
                objects.remove(pair)
    tree.write(setup)
    osim.ScaleTool(str(setup)).run()  # False without a marker placer, also where it has scaled
    if not end.is_file():
        raise NotConverged("OpenSim's scale tool did not scale the runner's model")
    return osim.Model(str(end))


def marker_names(model: Path) -> set[str]:
    """Names of a model's markers."""
    read = opensim().Model(str(model))  # the set below is only there as long as the model is
    markers = read.getMarkerSet()
    return {markers.get(k).getName() for k in range(markers.getSize())}


def _with_markers_of_the_run(model: Any) -> Any:
    osim = opensim()
    old = {
        m.getName(): m.clone()
        for m in (model.getMarkerSet().get(k) for k in range(model.getMarkerSet().getSize()))
    }
    paths = {name: (marker.getParentFrameName(), marker.get_location()) for name, marker in old.items()}
    places = {new: paths[walk] for new, walk in SAME.items()}
    origin = osim.Vec3(0.0)
    places |= {new: (f"/bodyset/{body}", origin) for new, body in (AT_JOINT | ANYWHERE).items()}
    model.updMarkerSet().clearAndDestroy()
    for new, (frame, location) in places.items():
        body = model.getBodySet().get(frame.split("/")[-1])
        model.addMarker(osim.Marker(new, body, osim.Vec3(location)))
    return model


def place_markers(model: Any, static: MarkerTrajectories, weights: Mapping[str, float]) -> None:
    """Moves all markers to where the static trial has them on their bodies, in the pose that OpenSim's IK finds.

    OpenSim's own marker placer does the same, but ends with an exception (std::bad_alloc) in the Python wheel of 4.6.

    Args:
        model: The model; its markers are moved.
        static: The static trial.
        weights: Weights of the markers in the pose; those of weight 0 are placed only.
    """
    osim = opensim()
    names = [name for name in static.names if model.getMarkerSet().contains(name)]
    mean = to_opensim(np.nanmean(static.select(tuple(names)).positions_m, axis=0))
    trusted = [k for k, name in enumerate(names) if weights.get(name, 0.0) > 0.0]
    pose = Pose(
        model,
        [names[k] for k in trusted],
        mean[None, trusted],
        np.zeros(1),
        weights={name: weights[name] for name in weights},
    )
    pose.solve(0)
    model.realizePosition(pose.state)
    places = []
    for k, name in enumerate(names):
        frame = model.getMarkerSet().get(name).getParentFrame()
        world = osim.Vec3(*mean[k].tolist())
        places.append(model.getGround().findStationLocationInAnotherFrame(pose.state, world, frame))
    for name, place in zip(names, places, strict=True):
        model.updMarkerSet().get(name).set_location(place)


def setup_weights(setup: Path) -> dict[str, float]:
    """Markers' weights in the pose of the static trial, of a scale setup."""
    tree, found = ET.parse(setup), {}
    for task in tree.iter("IKMarkerTask"):
        if (task.findtext("apply") or "").strip() == "true":
            found[str(task.get("name"))] = float(task.findtext("weight") or 0.0)
    return found


def correct_markers(model: Any, names: Sequence[str], lab_m: Array, times_s: Array, rounds: int) -> None:
    """Moves a model's markers to where a trial shows them on their bodies, as mbkf does with its own.

    In each round the model is posed on the trial by inverse kinematics, and each marker put at the mean of its measured
    places on its body.

    Args:
        model: The model; its markers are moved.
        names: (M,) markers.
        lab_m: (T, M, 3) their positions in OpenSim's axes, m; NaN where not seen.
        times_s: (T,) times of the frames.
        rounds: How often.
    """
    osim = opensim()
    some = np.arange(0, len(times_s), EVERY)
    for _ in range(rounds):
        pose = Pose(model, names, lab_m[some], times_s[some])
        seen: list[list[list[float]]] = [[] for _ in names]
        for t in range(len(some)):
            pose.solve(t)
            model.realizePosition(pose.state)
            for k in np.flatnonzero(~np.isnan(lab_m[some[t], :, 0])).tolist():
                frame = model.getMarkerSet().get(names[k]).getParentFrame()
                world = osim.Vec3(*lab_m[some[t], k].tolist())
                local = model.getGround().findStationLocationInAnotherFrame(pose.state, world, frame)
                seen[k].append([local.get(i) for i in range(3)])
        for name, places in zip(names, seen, strict=True):
            if places:
                mean = np.mean(places, axis=0).tolist()
                model.updMarkerSet().get(name).set_location(osim.Vec3(*mean))
