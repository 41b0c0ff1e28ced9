"""Results of one person as a data set of Motion-BIDS: measured markers and joint angles of each trial, foot events.

Every trial has two tracking systems: ``optical`` with the markers as measured, m, and ``mbkf`` with the joint angles,
deg. The columns of a ``motion.tsv`` are described in the ``channels.tsv`` beside it (Brain Imaging Data Structure,
version 1.10, Motion).
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.atomic import write_text
from mbkf.io.dimensions import ANGLE, AXES
from mbkf.io.results import Reconstruction
from mbkf.io.text import read_text
from mbkf.trial.exchange.even_frames import at_rows, even_rows
from mbkf.trial.exchange.result_c3d import foot_instants
from mbkf.version import __version__

BIDS_VERSION = "1.10.0"

FRAME = "world"
"""Name of the world's axes among the reference frames."""

PARTICIPANTS, ID = "participants.tsv", "participant_id"
"""Table of the set's persons, and its column of their labels."""

_CHANNELS = ("name", "component", "type", "tracked_point", "units", "reference_frame")


class Channel(NamedTuple):
    """A column of a ``motion.tsv``: its description, in the order of ``channels.tsv``, and its values (F,)."""

    name: str
    component: str
    kind: str
    point: str
    unit: str
    frame: str
    values: Array


def write_results_bids(results: Sequence[Reconstruction], folder: str | Path, person: str = "01") -> None:
    """Writes the data set; files about the whole set that are there already stay, with a row for a further person.

    Args:
        results: Results of the person's trials.
        folder: The folder of the data set.
        person: Label of the person, of letters and digits.

    Raises:
        InvalidInput: The label holds a character besides letters and digits, or ``results`` is empty.
        ProtectedFile: A file of a trial is there, and mbkf may not replace it.
        OSError: A file cannot be written.
    """
    if not (person.isalnum() and person.isascii()):
        raise InvalidInput(f"'{person}' is no label of a person in BIDS; use letters and digits only")
    if not results:
        raise InvalidInput(f"{folder}: nothing to write, there is no result")
    folder = Path(folder)
    for name, text in _of_the_set(results[0], person).items():
        if not (folder / name).exists():
            write_text(folder / name, text)
    _add_person(folder / PARTICIPANTS, _person(results[0], person))
    for result, task in zip(results, _tasks(results), strict=True):
        for name, text in _of_a_trial(result, f"sub-{person}_{task}").items():
            write_text(folder / f"sub-{person}" / "motion" / name, text)


def _of_the_set(r: Reconstruction, person: str) -> dict[str, str]:
    """Files about the whole set by their names."""
    description = {
        "Name": "Motion reconstructed by mbkf",
        "BIDSVersion": BIDS_VERSION,
        "DatasetType": "derivative",
        "GeneratedBy": [{"Name": "mbkf", "Version": __version__}],
    }
    columns = {
        "body_mass": {"Description": "mass of the body", "Units": "kg"},
        "height": {"Description": "height of the body", "Units": "m"},
    }
    row = _person(r, person)
    return {
        "dataset_description.json": _json(description),
        "README": "Markers as measured (tracksys-optical) and joint angles (tracksys-mbkf), written by mbkf.\n",
        PARTICIPANTS: _tsv([tuple(row), tuple(row.values())]),
        "participants.json": _json(columns),
    }


def _person(r: Reconstruction, person: str) -> Mapping[str, str]:
    """A person's row by the columns' names."""
    height = r.subject.height_m
    return {
        ID: f"sub-{person}",
        "body_mass": f"{r.subject.mass_kg:.6g}",
        "height": "n/a" if height is None else f"{height:.6g}",
    }


def _add_person(path: Path, row: Mapping[str, str]) -> None:
    """Adds a row to a table of persons that lacks it, in the columns that the table has."""
    lines = list(read_text(path, "a table of persons").lines)
    cells = [line.split("\t") for line in lines]
    if cells and ID in cells[0] and not any(row[ID] in one for one in cells):
        added = "\t".join(row.get(name, "n/a") for name in cells[0])
        write_text(path, "\n".join([*lines, added, ""]), edits=True)


def _tasks(results: Sequence[Reconstruction]) -> Iterator[str]:
    """Entity of each trial: its name's letters and digits, numbered where several are alike."""
    labels = ["".join(filter(_alphanumeric, r.trial)) or "trial" for r in results]
    for k, label in enumerate(labels):
        before = labels[:k].count(label)
        yield f"task-{label}" + (f"%s_run-{before + 1}" if labels.count(label) > 1 else "%s")


def _alphanumeric(letter: str) -> bool:
    return letter.isalnum() and letter.isascii()


def _of_a_trial(r: Reconstruction, stem: str) -> dict[str, str]:
    """Files of a trial by their names.

    Args:
        r: The result.
        stem: Beginning of the names, with ``%s`` for the tracking system.
    """
    rows = even_rows(r.times_s, r.rate_hz)
    start_s = float(r.times_s[0]) if r.frames else 0.0
    systems = {"optical": tuple(_markers(r)), "mbkf": tuple(_angles(r))}
    files = {}
    for system, channels in systems.items():
        name = stem % f"_tracksys-{system}"
        values = at_rows(np.column_stack([one.values for one in channels]), rows)
        files[f"{name}_motion.tsv"] = _tsv([_number(one) for one in row] for row in values)
        files[f"{name}_motion.json"] = _json(_about(r, system, channels, len(rows)))
        files[f"{name}_channels.tsv"] = _tsv([_CHANNELS, *(one[:-1] for one in channels)])
        files[f"{name}_channels.json"] = _json({"reference_frame": {"Levels": {FRAME: _world()}}})
    events = [(f"{at_s - start_s:.6g}", "0", f"{label}, {side}") for at_s, label, side in foot_instants(r)]
    if events:
        name = stem % ""
        files[f"{name}_events.tsv"] = _tsv([("onset", "duration", "trial_type"), *events])
    return files


def _markers(r: Reconstruction) -> Iterator[Channel]:
    for k, name in enumerate(r.marker_names):
        for axis, values in zip(AXES["xyz"].labels, r.measured_m[:, k].T, strict=True):
            yield Channel(f"{name}_{axis}", axis, "POS", name, "m", FRAME, values)


def _angles(r: Reconstruction) -> Iterator[Channel]:
    for name in r.coordinate_names:
        if ANGLE.of(name) == "rad":
            values = np.degrees(np.where(r.tracked, r.angle(name), np.nan))
            yield Channel(name, "n/a", "JNTANG", name, "deg", "n/a", values)


def _about(r: Reconstruction, system: str, channels: Sequence[Channel], frames: int) -> Mapping[str, object]:
    return {
        "TaskName": "".join(filter(_alphanumeric, r.trial)) or "trial",
        "SamplingFrequency": r.rate_hz,
        "TrackingSystemName": system,
        "RecordingType": "continuous",
        "RecordingDuration": frames / r.rate_hz,
        "MotionChannelCount": len(channels),
        "TrackedPointsCount": len({one.point for one in channels}),
        "MissingValues": "n/a",
        "SoftwareVersions": f"mbkf {r.version}",
        f"{channels[0].kind}ChannelCount": len(channels),
    }


def _world() -> Mapping[str, str]:
    """The world's axes: forward, left, up."""
    return {"SpatialAxes": "FLU", "RotationRule": "right-hand", "RotationOrder": "XYZ"}


def _number(value: float) -> str:
    return f"{value:.9g}" if np.isfinite(value) else "n/a"


def _tsv(rows: Iterator[Sequence[str]] | Sequence[Sequence[str]]) -> str:
    return "".join("\t".join(row) + "\n" for row in rows)


def _json(value: object) -> str:
    return json.dumps(value, indent=2) + "\n"
