"""The source's first data base: motions of AMASS as virtual sensors, through files and commands, and its formulas.

No file of AMASS is at hand (its licence asks each user to register), so that the file is made here: the joint rotations
of a synthetic walk and of a standing person, in the format of AMASS. A user would run everything after it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.commands import mbkf
from benchmarks.madgwick.as_printed import printed_accelerations, printed_rates
from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.imu.virtual import ImuErrors, virtual_imus
from mbkf.io.amass import JOINTS, read_amass
from mbkf.io.imu.mount import ImuMount
from mbkf.io.storage import read_storage
from mbkf.model.human import HumanModel
from mbkf.model.segment_poses import segment_poses
from mbkf.scaling.stature import person_of_stature
from mbkf.synthesis.motion import synthesise_motion
from mbkf.synthesis.smpl import SEGMENTS, axes_at_rest, motion_of_smpl

PERSON = ("--mass", "72", "--height", "1.78")
SECONDS, STANDING_S, RATE_HZ = 6.0, 3.0, 120.0
JOINT_ANGLES = ("hip_flexion", "knee_angle", "ankle_angle")
FILTERS = ("madgwick", "ekf", "smooth")


@dataclass(frozen=True)
class FirstBase:
    """Results.

    Attributes:
        joints_rad: Largest difference of a joint rotation between the file and our body.
        angle_rms_deg: By filter and joint, both sides, root mean square difference to the angles of the true
            orientations, by `mbkf imu angles`.
        rate_factor: Angular velocities by Madgwick eqs. 39 to 43 over the true ones, median.
        rate_error, acceleration_error_mps2: Relative error of these once halved; RMS error of Madgwick eq. 38.
        skeleton: Number of joints compared.
    """

    joints_rad: float
    angle_rms_deg: dict[tuple[str, str], float]
    rate_factor: float
    rate_error: float
    acceleration_error_mps2: float
    skeleton: int


def measure_first_base(folder: Path) -> FirstBase:
    """Makes the files in a folder, runs the commands on them, and reads their results."""
    person = person_of_stature(72.0, 1.78)
    model = HumanModel.of(person)
    walk = synthesise_motion(model, "walk", SECONDS, RATE_HZ, 0)
    rotations, trans = skeleton_of(model, walk.q)
    file, still = folder / "walk_poses.npz", folder / "stand_poses.npz"
    write_amass(file, rotations, trans)
    standing = np.repeat(model.neutral()[None], round(STANDING_S * RATE_HZ), axis=0)
    write_amass(still, *skeleton_of(model, standing))
    joints, count = _joints(model, file, rotations)
    angles = _angles(folder, file, still)
    return FirstBase(joints, angles, *_printed(model, walk.q, walk.v, walk.a), count)


def skeleton_of(model: HumanModel, q: Array) -> tuple[Array, Array]:
    """(T, 22, 3) joint rotations of SMPL and (T, 3) places of its root for configurations of our body.

    Args:
        model: The body.
        q: (T, nq) its configurations.
    """
    poses = segment_poses(model, q)
    parts = {
        SEGMENTS[segment]: Rotation.from_quat(poses[:, k, 3:])
        * Rotation.from_matrix(axes_at_rest(segment)).inv()
        for k, segment in enumerate(model.joints)
    }
    parents = {"spine3": "pelvis", "neck": "spine3", "head": "neck"}
    for side in ("left", "right"):
        parents |= {
            f"{side}_shoulder": "spine3",
            f"{side}_elbow": f"{side}_shoulder",
            f"{side}_wrist": f"{side}_elbow",
        }
        parents |= {f"{side}_hip": "pelvis", f"{side}_knee": f"{side}_hip", f"{side}_ankle": f"{side}_knee"}
        parents[f"{side}_foot"] = f"{side}_ankle"
    rotations = np.zeros((len(q), len(JOINTS), 3))
    for joint, whole in parts.items():
        turn = whole if joint == "pelvis" else parts[parents[joint]].inv() * whole
        rotations[:, JOINTS.index(joint)] = turn.as_rotvec()
    names = list(model.joints)
    hips = [poses[:, names.index(f"{side}_thigh"), :3] for side in ("left", "right")]
    return rotations, 0.5 * (hips[0] + hips[1])


def write_amass(path: Path, rotations: Array, trans: Array) -> None:
    """Writes an .npz as AMASS has it (SMPL-H, 52 joints).

    Args:
        path: The file.
        rotations: (T, 22, 3) rotation vectors of the body's joints, rad.
        trans: (T, 3) places of the root, m.
    """
    poses = np.zeros((len(rotations), 156))
    poses[:, :66] = rotations.reshape(len(rotations), -1)
    np.savez(
        path, poses=poses, trans=trans, betas=np.zeros(16), dmpls=np.zeros((len(poses), 8)),
        gender=np.array("female"), mocap_framerate=np.array(RATE_HZ),
    )  # fmt: skip


def _joints(model: HumanModel, file: Path, rotations: Array) -> tuple[float, int]:
    """The file read onto the body, and its joint rotations read from the body again."""
    found, _ = skeleton_of(model, motion_of_smpl(model, read_amass(file)).q)
    compared = [JOINTS.index(joint) for joint in SEGMENTS.values()]
    turns = [Rotation.from_rotvec(each[:, compared].reshape(-1, 3)) for each in (found, rotations)]
    return float((turns[0] * turns[1].inv()).magnitude().max()), len(compared)


def _angles(folder: Path, file: Path, still: Path) -> dict[tuple[str, str], float]:
    """Through `imu synth` and `imu angles`: by each filter against the true orientations in the same file."""
    mbkf("imu", "synth", still, *PERSON, "--rate", "60", "--seed", "1", "--out", folder / "stand.csv")
    placed = ("--mounts", folder / "stand.toml")
    mbkf("imu", "synth", file, *PERSON, *placed, "--rate", "60", "--seed", "1", "--out", folder / "walk.csv")
    standing = ("--standing", folder / "stand.csv")
    mbkf("imu", "angles", folder / "walk.csv", *standing, "--from-file", "--out", folder / "true")
    true = read_storage(folder / "true" / "angles.mot")
    found = {}
    for name in FILTERS:
        mbkf("imu", "angles", folder / "walk.csv", *standing, "--filter", name, "--out", folder / name)
        table = read_storage(folder / name / "angles.mot")
        for joint in JOINT_ANGLES:
            off = np.array(
                [table.column(f"{joint}_{side}") - true.column(f"{joint}_{side}") for side in "rl"]
            )
            found[name, joint] = float(np.sqrt(np.mean(off**2)))
    return found


def _printed(model: HumanModel, q: Array, v: Array, a: Array) -> tuple[float, float, float]:
    """Madgwick eqs. 38 to 43 on the right thigh's origin, whose motion is known exactly."""
    times, names = np.arange(len(q)) / RATE_HZ, list(model.joints)
    mount = ImuMount("thigh", "right_thigh", np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]))
    (true,) = virtual_imus(model, times, q, v, a, [mount], errors=ImuErrors.none())
    poses = segment_poses(model, q)[:, names.index("right_thigh")]
    turns = Rotation.from_quat(poses[:, 3:])
    rates = printed_rates(turns.as_matrix(), 1.0 / RATE_HZ)
    between = 0.5 * (true.angular_velocity_rad_s[1:] + true.angular_velocity_rad_s[:-1])
    factor = float(np.median(np.linalg.norm(rates, axis=1) / np.linalg.norm(between, axis=1)))
    error = np.sqrt(np.mean((0.5 * rates - between) ** 2) / np.mean(between**2))
    exact = turns.apply(np.array(true.specific_force_mps2)) - [0.0, 0.0, GRAVITY_M_S2]
    accelerations = printed_accelerations(poses[:, :3], 1.0 / RATE_HZ)
    return factor, float(error), float(np.sqrt(np.mean((accelerations - exact[1:-1]) ** 2)))
