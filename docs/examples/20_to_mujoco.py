"""A result in MuJoCo: key frames hold the motion, and MuJoCo's inverse dynamics gives the torques of mbkf."""

from subprocess import run
from sys import executable

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

import mbkf

for words in (
    "synth --motion squat --seconds 1 --seed 3 --out lab",
    "reconstruct lab/trial.c3d --subject lab/subject.toml --out result",
    "export result --to mjcf --out squat.xml",
):
    run([executable, "-m", "mbkf", *words.split()], check=True, capture_output=True)

result = mbkf.read_reconstruction("result")
model = mujoco.MjModel.from_xml_path("squat.xml")
data = mujoco.MjData(model)
print(f"{model.nkey} key frames, {model.nv} degrees of freedom, {model.body_mass.sum():.2f} kg")

largest = 0.0
for t in range(0, model.nkey, 10):  # frames in which the body is followed; here all
    mujoco.mj_resetDataKeyframe(model, data, t)
    v, a = result.v[t], result.a[t]
    R = Rotation.from_quat(result.q[t, 3:7]).as_matrix()  # the root's own axes in the world's
    data.qacc[:] = a
    # MuJoCo: acceleration of the root's place in the world
    data.qacc[:3] = R @ (a[:3] + np.cross(v[3:6], v[:3]))
    mujoco.mj_inverse(model, data)

    ground = np.zeros(model.nv)  # generalised forces of the ground
    for foot, wrench in zip(("right_foot", "left_foot"), result.foot_wrench[t], strict=True):
        body = model.body(foot).id
        at = data.xpos[body]
        # about the ankle, of the moment about the world's origin
        moment = wrench[3:] - np.cross(at, wrench[:3])
        mujoco.mj_applyFT(model, data, wrench[:3], moment, at, body, ground)
    torque = (data.qfrc_inverse - ground)[6:]
    largest = max(largest, np.abs(torque - result.tau[t, 6:]).max())

print(
    f"joint torques differ by {largest:.1e} N m at most; the largest is {np.abs(result.tau[:, 6:]).max():.0f} N m"
)
assert largest < 1e-6
