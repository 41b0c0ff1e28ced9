"""A result for Blender: a skeleton (BVH) and the drawn body (GLB), at the result's own frame rate."""

import json
import struct
from pathlib import Path
from subprocess import run
from sys import executable

import mbkf

for words in (
    "synth --motion squat --seconds 1 --seed 3 --out lab",
    "reconstruct lab/trial.c3d --subject lab/subject.toml --out result",
    "export result --to bvh --out squat.bvh",
    "export result --to glb --out squat.glb",
):
    run([executable, "-m", "mbkf", *words.split()], check=True, capture_output=True)

result = mbkf.read_reconstruction("result")
lines = Path("squat.bvh").read_text().splitlines()
frames, step_s = (
    float(next(one for one in lines if one.startswith(key)).split()[-1]) for key in ("Frames:", "Frame Time:")
)
content = Path("squat.glb").read_bytes()
scene = json.loads(content[20 : 20 + struct.unpack("<I", content[12:16])[0]])
last_s = max(one["max"][0] for one in scene["accessors"] if one.get("type") == "SCALAR" and "max" in one)
print(f"BVH: {frames:.0f} frames every {step_s:g} s; GLB: keys from 0 to {last_s:g} s")
assert frames == result.frames and step_s == 1.0 / result.rate_hz
assert abs(last_s - (result.frames - 1) / result.rate_hz) < 1e-6

try:
    import bpy
except ImportError:
    print("not opened: needs Blender as a module (pip install bpy)")
else:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    # before the file: then every frame of the result is one of the scene
    scene.render.fps = round(result.rate_hz)
    bpy.ops.import_scene.gltf(filepath="squat.glb")
    scene.frame_start, scene.frame_end = 0, result.frames - 1
    (action, *_) = bpy.data.actions
    print(
        f"Blender: {scene.frame_end + 1} frames at {scene.render.fps} a second, keys {tuple(action.frame_range)}"
    )
    assert tuple(action.frame_range) == (0.0, scene.frame_end)
