"""Mass of a body's URDF and MJCF in the programs that read them."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pinocchio as pin
import yourdfpy

import mbkf
from benchmarks.checks import Check, left_out
from benchmarks.needs import installed
from mbkf.trial.export import export_subject

SHARE = 1e-6

_PYBULLET = """
import sys, pybullet as p
p.connect(p.DIRECT)
body = p.loadURDF(sys.argv[1], flags=p.URDF_USE_INERTIA_FROM_FILE)
print("kg", repr(sum(p.getDynamicsInfo(body, k)[0] for k in range(-1, p.getNumJoints(body)))))
"""
"""In a process of its own, which prints what its NumPy says."""


def body_weight_rows(out: Path) -> Iterator[Check]:
    """Difference of each program's mass from the person's, as a share of it.

    Args:
        out: Folder for the files.
    """
    subject, _ = mbkf.synthesise("squat", seconds=1.0)
    urdf, mjcf = out / "body.urdf", out / "body.xml"
    export_subject(subject, "urdf", urdf)
    export_subject(subject, "mjcf", mjcf)

    def row(program: str, mass_kg: float) -> Check:
        return Check(
            f"mass in {program}", abs(mass_kg / subject.mass_kg - 1.0), SHARE, "<=", "of the person's"
        )

    model = pin.buildModelFromUrdf(str(urdf), pin.JointModelFreeFlyer())
    yield row("Pinocchio", pin.computeTotalMass(model))
    links = yourdfpy.URDF.load(str(urdf), load_meshes=False, build_scene_graph=False).robot.links
    yield row("yourdfpy", sum(float(link.inertial.mass) for link in links if link.inertial))
    yield row("load_body", mbkf.load_body(urdf).reference_mass_kg)
    if installed("mujoco"):
        import mujoco

        spec = mujoco.MjSpec.from_file(str(urdf))
        spec.body("pelvis").add_freejoint()
        yield row("MuJoCo, URDF", spec.compile().body_mass.sum())
        yield row("MuJoCo, MJCF", mujoco.MjModel.from_xml_path(str(mjcf)).body_mass.sum())
    if not installed("pybullet"):
        yield left_out("mass in PyBullet", "needs pybullet: pip install '.[bridges]'")
        return
    words = [sys.executable, "-c", _PYBULLET, str(urdf)]
    done = subprocess.run(words, capture_output=True, text=True, check=False).stdout.splitlines()
    kilograms = next((float(line.split()[1]) for line in done if line.startswith("kg ")), float("nan"))
    yield row("PyBullet, URDF", kilograms)
