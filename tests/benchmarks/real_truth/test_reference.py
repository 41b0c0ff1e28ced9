"""References: signs, units and order of rotations of each program."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.real_truth.persons import IN_C3D, OPENSIM, RBDL, RealPerson, RealTrial, Reference
from benchmarks.real_truth.reference import read_reference

MASS_KG = 50.0


def read(tmp_path, reference, capture=None):
    trial = RealTrial("walk", "walk.c3d", reference)
    return read_reference(tmp_path, RealPerson("A", ".", "", MASS_KG, (trial,)), trial, capture)


def storage(path: Path, columns, degrees):
    names, rows = list(columns), np.column_stack(list(columns.values()))
    head = (
        f"{path.name}\nversion=1\nnRows={len(rows)}\nnColumns={len(names)}\ninDegrees={degrees}\nendheader\n"
    )
    body = "\n".join("\t".join(f"{x:.9g}" for x in row) for row in rows)
    path.write_text(head + "\t".join(names) + "\n" + body + "\n")


def test_opensim_s_paths_radians_and_a_knee_that_extends(tmp_path):
    times = np.array([0.0, 0.1, 0.2])
    coordinates = {
        "time": times,
        "/jointset/hip_r/hip_flexion_r/value": np.radians([10.0, 20.0, 30.0]),
        "/jointset/knee_r/knee_angle_r/value": np.radians([-40.0, -50.0, -60.0]),
    }
    storage(tmp_path / "ik.sto", coordinates, "no")
    loads = {"time": times}
    for name in ("hip_flexion", "knee_angle", "ankle_angle"):
        loads |= {f"{name}_{side}_moment": np.full(3, 25.0) for side in "rl"}
    loads |= {
        f"pelvis_t{axis}_force": np.full(3, force) for axis, force in zip("xyz", (2.0, 3.0, 6.0), strict=True)
    }
    storage(tmp_path / "id.sto", loads, "no")
    found = read(tmp_path, Reference(OPENSIM, "ik.sto", "id.sto", knee=-1.0))
    assert set(found.angles) == {"hip_flexion_r", "knee_angle_r"}
    assert found.angles["hip_flexion_r"].values == pytest.approx([10.0, 20.0, 30.0])
    assert found.angles["knee_angle_r"].values == pytest.approx([40.0, 50.0, 60.0])
    assert found.moments["hip_flexion_l"].values == pytest.approx(np.full(3, 0.5))
    assert found.moments["knee_angle_l"].values == pytest.approx(np.full(3, -0.5))
    assert found.residual_n == pytest.approx(7.0)


def test_plug_in_gait_s_points_have_gaps_of_zeros_and_moments_that_extend():
    angle = np.array([[10.0, 1.0, 2.0], [0.0, 0.0, 0.0], [30.0, 1.0, 2.0]])
    points = (
        SimpleNamespace(name="RHipAngles", values=angle),
        SimpleNamespace(name="LKneeAngles", values=np.zeros((3, 3))),
        SimpleNamespace(name="RHipMoment", values=100.0 * angle),
    )
    capture = SimpleNamespace(derived=points, markers=SimpleNamespace(times_s=np.array([0.0, 0.1, 0.2])))
    found = read(Path(), Reference(IN_C3D), capture)
    assert set(found.angles) == {"hip_flexion_r"}
    np.testing.assert_allclose(found.angles["hip_flexion_r"].values, [10.0, np.nan, 30.0])
    np.testing.assert_allclose(found.moments["hip_flexion_r"].values, [-1.0, np.nan, -3.0])


def test_rbdl_s_rotations_are_turned_into_flexion_first(tmp_path):
    flexion, adduction, rotation = 60.0, 15.0, 20.0
    turned = Rotation.from_euler("YXZ", [-flexion, adduction, rotation], degrees=True).as_euler("XYZ")
    row = np.zeros(25)
    row[7:10], row[10:13] = turned, [0.0, np.radians(30.0), 0.0]
    np.savetxt(tmp_path / "q.csv", np.array([row, row]), delimiter=",")
    found = read(tmp_path, Reference(RBDL, "q.csv"))
    assert found.angles["hip_flexion_r"].values == pytest.approx([flexion, flexion])
    assert found.angles["knee_angle_r"].values == pytest.approx([30.0, 30.0])
    assert found.angles["ankle_angle_l"].values == pytest.approx([0.0, 0.0])
