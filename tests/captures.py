"""A person made for tests: the reference body and markers, standing or moving a little, on two plates."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mbkf.cli.main import main
from mbkf.conventions import GRAVITY_M_S2
from mbkf.io.c3d_write import write_c3d
from mbkf.io.records import Capture, MarkerTrajectories, PlateReadings
from mbkf.io.trc import write_trc
from mbkf.model.human import HumanModel
from mbkf.model.protocol import load_protocol
from mbkf.sensors.contact.soles import sole_points
from mbkf.sensors.marker_sensor import MarkerSensor
from tests.mot_files import write_forces_mot

RATE_HZ = 100.0
MASS_KG = 75.0
LEGS = ("pelvis", "thigh", "shank", "foot", "toes")


@dataclass(frozen=True)
class Person:
    """Files of one made person: captures, ground reactions and the scaled subject."""

    static: Path
    trial: Path
    trial_trc: Path
    forces: Path
    subject: Path


def made_markers(
    frames: int = 60, amplitude_rad: float = 0.06, noise_m: float = 0.0005
) -> MarkerTrajectories:
    """The reference body with all joints swinging a little about standing; amplitude 0 stands still."""
    model = HumanModel.scaled(mass_kg=MASS_KG)
    followed = [marker for marker in load_protocol("reference36").markers if marker.kind != "computed"]
    sensor = MarkerSensor(model, [m.segment for m in followed], np.array([m.position_m for m in followed]))
    rng = np.random.default_rng(3)
    size = rng.uniform(-1.0, 1.0, model.nv) * amplitude_rad
    size[:6] *= 0.2
    start = model.neutral()
    start[2] -= sole_points(model, start[None])[0, :, :, 2].min()
    swing = np.sin(2 * np.pi * np.arange(frames) / RATE_HZ / 0.8)
    positions = np.array([sensor.positions(model.integrate(start, s * size)) for s in swing])
    positions += rng.normal(0.0, noise_m, positions.shape)
    return MarkerTrajectories(tuple(m.name for m in followed), positions, RATE_HZ)


def made_plates(frames: int = 60) -> tuple[PlateReadings, ...]:
    """One plate under each foot, each with half of the weight, below the centre of mass from ahead to behind."""
    model = HumanModel.scaled(mass_kg=MASS_KG)
    soles = sole_points(model, model.neutral()[None])[0].mean(axis=1)
    x = model.centre_of_mass(model.neutral())[0]
    force = np.tile([0.0, 0.0, 0.5 * MASS_KG * GRAVITY_M_S2], (10 * frames, 1))
    plates = []
    for name, (_, y, _) in zip(("1", "2"), soles, strict=True):
        middle = np.array([x, y, 0.0])
        corners = middle + np.array(
            [[0.2, -0.08, 0.0], [-0.2, -0.08, 0.0], [-0.2, 0.08, 0.0], [0.2, 0.08, 0.0]]
        )
        point = np.tile(middle, (len(force), 1))
        plates.append(
            PlateReadings(name, 10 * RATE_HZ, 0.0, middle, force, 0.0 * force, point, 20.0, corners)
        )
    return tuple(plates)


def made_capture(frames: int = 60, amplitude_rad: float = 0.06, **changes: object) -> Capture:
    """Markers and plates; ``changes`` replace fields of the capture."""
    capture = Capture("", made_markers(frames, amplitude_rad), made_plates(frames), subject_mass_kg=MASS_KG)
    return replace(capture, **changes)


def only(markers: MarkerTrajectories, segments: tuple[str, ...]) -> MarkerTrajectories:
    """The markers on segments whose name holds one of the words."""
    carried = {m.name: m.segment for m in load_protocol("reference36").markers}
    names = tuple(n for n in markers.names if any(word in carried[n] for word in segments))
    return markers.select(names)


def write_person(folder: Path) -> Person:
    """Writes the captures and scales the subject from the static one."""
    folder.mkdir(parents=True, exist_ok=True)
    person = Person(
        *(folder / name for name in ("static.c3d", "trial.c3d", "trial.trc", "grf.mot", "person.toml"))
    )
    write_c3d(made_capture(30, 0.0), person.static)
    moving = made_capture()
    write_c3d(moving, person.trial)
    write_trc(moving.markers, person.trial_trc)
    write_forces_mot(moving.plates, person.forces)
    assert main(["scale", str(person.static), "--mass", str(MASS_KG), "--out", str(person.subject)]) == 0
    return person


def snapshot(folder: Path) -> dict[str, bytes | None]:
    """Everything below a folder: content of files, None for folders."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes() if path.is_file() else None
        for path in folder.rglob("*")
    }
