"""An exported URDF file in other programs, and read back by mbkf: masses, visuals, kinematics."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

import mbkf
from benchmarks.checks import Check, left_out
from benchmarks.needs import installed
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel
from mbkf.model.urdf_tree import read_urdf_tree
from mbkf.trial.export import export_subject

MASS_KG = READ_BACK = 1e-9
STATES = 10


def urdf_rows(subject: Subject, out: Path, rng: np.random.Generator) -> list[Check]:
    """Rows of a person's file.

    Args:
        subject: The person.
        out: Folder for the file.
        rng: Draws the postures.
    """
    path = out / "person.urdf"
    export_subject(subject, "urdf", path)
    model = HumanModel.of(subject)
    links = len(model.joints) + len(subject.markers)
    found = [*_read_by("Pinocchio", *_pinocchio(path), model.mass_kg, links)]
    for name, module, read in (("MuJoCo", "mujoco", _mujoco), ("PyBullet", "pybullet", _pybullet)):
        if installed(module):
            found += _read_by(name, *read(path), model.mass_kg, links)
        else:
            found.append(left_out(f"URDF in {name}: total mass off", f"needs {module}: pip install {module}"))
    return [*found, *_read_back(path, model, rng)]


def _read_by(name: str, mass_kg: float, visuals: int, wanted_kg: float, links: int) -> list[Check]:
    return [
        Check(f"URDF in {name}: total mass off", abs(mass_kg - wanted_kg), MASS_KG, "<=", "kg"),
        Check(f"URDF in {name}: visuals, at least one a segment and marker", visuals, links, ">="),
    ]


def _pinocchio(path: Path) -> tuple[float, int]:
    body, _, visuals = pin.buildModelsFromUrdf(str(path), str(path.parent), pin.JointModelFreeFlyer())
    return sum(float(one.mass) for one in body.inertias), int(visuals.ngeoms)


def _mujoco(path: Path) -> tuple[float, int]:
    import mujoco

    spec = mujoco.MjSpec.from_file(str(path))
    spec.body(read_urdf_tree(path).root).add_freejoint()
    body = spec.compile()
    return float(body.body_mass.sum()), int(body.ngeom)


def _pybullet(path: Path) -> tuple[float, int]:
    bullet: Any = importlib.import_module("pybullet")
    client = bullet.connect(bullet.DIRECT)
    try:
        body = bullet.loadURDF(str(path), flags=bullet.URDF_USE_INERTIA_FROM_FILE, physicsClientId=client)
        links = range(-1, bullet.getNumJoints(body, physicsClientId=client))
        masses = [bullet.getDynamicsInfo(body, link, physicsClientId=client)[0] for link in links]
        return float(sum(masses)), len(bullet.getVisualShapeData(body, physicsClientId=client))
    finally:
        bullet.disconnect(client)


def _read_back(path: Path, model: HumanModel, rng: np.random.Generator) -> list[Check]:
    again = HumanModel.scaled(body=mbkf.load_body(path))
    inertias = zip(again.pin_model.inertias, model.pin_model.inertias, strict=True)
    apart = max(float(np.abs(a.toDynamicParameters() - b.toDynamicParameters()).max()) for a, b in inertias)
    postures = [model.integrate(model.neutral(), rng.uniform(-0.7, 0.7, model.nv)) for _ in range(STATES)]
    places = max(float(np.abs(again.frames(q) - model.frames(q)).max()) for q in postures)
    return [
        Check("URDF read back: inertial parameters apart", apart, READ_BACK, "<=", "kg, kg m, kg m²"),
        Check(f"URDF read back: frames in {STATES} postures apart", places, READ_BACK, "<=", "m"),
    ]
