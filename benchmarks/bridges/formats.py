"""Files of a result in the programs that read them: Motion-BIDS's validator, Blender, MuJoCo, pandas."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import mbkf
from benchmarks.checks import Check, left_out
from benchmarks.needs import installed
from mbkf.io.results import Reconstruction
from mbkf.trial.exchange.summary_table import CHARTED

MOST_COLUMNS, PLACE_M, TORQUE_NM = 60, 1e-6, 1e-6
SECONDS = 4.0
"""Longer than the 250 frames of a new scene in Blender."""

_BLENDER = """
import bpy, json, sys
rate, frames = float(sys.argv[1]), int(sys.argv[2])
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_anim.bvh(filepath="walk.bvh", update_scene_fps=True, update_scene_duration=True)
scene = bpy.context.scene
found = {"bvh rate": scene.render.fps / scene.render.fps_base, "bvh end": scene.frame_end}
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.render.fps = round(rate)
bpy.ops.import_scene.gltf(filepath="walk.glb")
found["glb end"] = max(action.frame_range[1] for action in bpy.data.actions)
print("found", json.dumps(found))
"""

_NOTHING = 'found {"bvh rate": NaN, "bvh end": NaN, "glb end": NaN}'
"""Answer of a Blender that ended before its own."""


def formats_rows(out: Path) -> Iterator[Check]:
    """Rows of all programs.

    Args:
        out: Folder for the files.
    """
    subject, recorded = mbkf.synthesise("walk", seconds=SECONDS)
    result = mbkf.reconstruct(recorded.trial, subject)
    for kind, name in (("csv", "walk.csv"), ("mjcf", "walk.xml"), ("bvh", "walk.bvh"), ("glb", "walk.glb")):
        mbkf.export_result(result, kind, out / name)
    mbkf.export_result(result, "bids", out / "set")
    yield Check("key numbers: columns of the row", float(len(CHARTED)), float(MOST_COLUMNS), "<=")
    yield from _pandas(result, out / "walk.csv")
    yield from _mujoco(result, out / "walk.xml")
    yield from _bids(out / "set")
    yield from _blender(result, out)


def _pandas(result: Reconstruction, path: Path) -> Iterator[Check]:
    if not installed("pandas"):
        yield left_out("wide table in pandas", "needs pandas: pip install '.[test]'")
        return
    import pandas as pd

    table = pd.read_csv(path)
    apart = max(
        np.abs(np.radians(table[f"{name}_deg"]) - result.angle(name)).max()
        for name in ("hip_flexion_r", "knee_angle_l")
    )
    yield Check("wide table in pandas: angles", float(apart), 1e-9, "<=", "rad")
    yield Check("wide table in pandas: rows missing", float(abs(len(table) - result.frames)), 0.0, "<=")


def _mujoco(result: Reconstruction, path: Path) -> Iterator[Check]:
    if not installed("mujoco"):
        yield left_out("key frames in MuJoCo", "needs mujoco: pip install '.[test]'")
        return
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(path))
    data, worst = mujoco.MjData(model), 0.0
    for key in range(0, model.nkey, 20):
        mujoco.mj_resetDataKeyframe(model, data, key)
        mujoco.mj_forward(model, data)
        seen = result.present[key]
        sites = np.array([data.site(name).xpos for name in result.marker_names])
        worst = max(worst, float(np.abs(sites - result.predicted_m[key])[seen].max()))
    yield Check("key frames in MuJoCo: markers", worst, PLACE_M, "<=", "m")


def _bids(folder: Path) -> Iterator[Check]:
    if not installed("bids_validator_deno"):
        yield left_out("faults by the BIDS validator", "needs bids-validator-deno: pip install '.[bridges]'")
        return
    program = Path(sys.executable).with_name("bids-validator-deno")
    words = [str(program), "--json", str(folder)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    issues = json.loads(done.stdout)["issues"]["issues"]
    yield Check(
        "faults by the BIDS validator", float(sum(i["severity"] == "error" for i in issues)), 0.0, "<="
    )


def _blender(result: Reconstruction, folder: Path) -> Iterator[Check]:
    """The rate that Blender's scene has, and its last frame, with the settings that the page on Blender states."""
    if not installed("bpy"):
        yield left_out("scene in Blender", "needs bpy: pip install '.[bridges]'")
        return
    words = [sys.executable, "-c", _BLENDER, str(result.rate_hz), str(result.frames)]
    done = subprocess.run(words, capture_output=True, text=True, check=False, cwd=folder).stdout.splitlines()
    found = json.loads(
        next((line for line in done if line.startswith("found")), _NOTHING).removeprefix("found")
    )
    rate, last, keys = found["bvh rate"], found["bvh end"], found["glb end"]
    yield Check("BVH in Blender: rate of the scene", abs(rate - result.rate_hz), 1e-3, "<=", "Hz")
    yield Check("BVH in Blender: frames that the scene lacks", float(result.frames - last), 0.0, "<=")
    yield Check("GLB in Blender: last key from the last frame", abs(keys - (result.frames - 1)), 1e-3, "<=")
