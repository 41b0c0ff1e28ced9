"""OpenSim models as bodies of ours: an exported person comes back and walks, other models follow their own motions.

The person's markers have their true places in the model and are recorded with 0.01 mm of noise, so that only the way
through file, scaling and filter can err. They are followed with a noise of 0.5 mm in place of skin's 5 mm.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

import mbkf
from benchmarks.bridges.opensim_models import model_rows
from benchmarks.bridges.opensim_onto import LEGS
from benchmarks.checks import Check
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.model.osim import osim_coordinates, osim_files
from mbkf.model.protocol import load_protocol
from mbkf.model.urdf_body import side_path
from mbkf.synthesis.capture import CaptureSettings

ANGLE_DEG, MASS, SEED, SECONDS = 0.1, 1e-9, 4, 2.0
EXACT = CaptureSettings(1e-5, 0.0, 0.8, 0.0, 0, 0.01, 0.001, (-0.01, 0.01))
"""Instruments that hardly err: noise of markers, skin, plates, and their offset."""

PLACED_M = 5e-4
"""Spread of the markers' places and noise in the protocol."""

SIDE = """reference_height_m = 1.75

[roles]
feet = ["right_foot", "left_foot"]
toes = ["right_toes", "left_toes"]

[sole]
height_m = -0.07
heel_x_m = -0.06
ball_x_m = 0.13
toe_x_m = 0.2
inner_y_m = 0.04
outer_y_m = -0.05
"""


def opensim_in_rows(data: Path, out: Path) -> Iterator[Check]:
    """Rows of the exported person, and of the captures' models.

    Args:
        data: Folder of the reference captures.
        out: Folder for the exported files.
    """
    person, recorded = mbkf.synthesise("walk", seconds=SECONDS, seed=SEED, settings=EXACT)
    model, path = HumanModel.of(person), out / "person.osim"
    path.write_text(osim_files(model, person.markers, path.name)[path.name], encoding="utf-8")
    side_path(path).write_text(SIDE, encoding="utf-8")
    protocol = load_protocol(path)
    markers = tuple(replace(one, placement_sd_m=PLACED_M, noise_m=PLACED_M) for one in protocol.markers)
    found = mbkf.scale(
        recorded.static, mass_kg=model.mass_kg, body=path, protocol=replace(protocol, markers=markers)
    )
    yield Check(
        "exported person: mass off", abs(protocol.body.reference_mass_kg / model.mass_kg - 1.0), MASS, "<="
    )
    result = mbkf.reconstruct(recorded.trial, found)
    body, rows = HumanModel.of(found), result.tracked
    ours, truth = osim_coordinates(body, result.q[rows]), osim_coordinates(model, recorded.truth.q[rows])
    names, true_names = ClinicalAngles(body).names, ClinicalAngles(model).names
    apart = {
        name: float(np.sqrt(np.mean((ours[:, names.index(name)] - truth[:, true_names.index(name)]) ** 2)))
        for name in LEGS
    }
    worst = max(apart, key=lambda one: apart[one])
    yield Check(f"exported person walks: {worst}", float(np.rad2deg(apart[worst])), ANGLE_DEG, "<=", "°")
    yield from model_rows(data, out)
