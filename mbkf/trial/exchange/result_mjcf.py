"""A result as MJCF: the person's body, and the motion as key frames with positions and velocities.

A program shows frame k of the motion by ``mujoco.mj_resetDataKeyframe(model, data, k)``.
"""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.atomic import write_text
from mbkf.io.results import Reconstruction
from mbkf.io.written import MARK
from mbkf.model.body import Body
from mbkf.model.clinical import configuration_names
from mbkf.model.human import HumanModel
from mbkf.model.mjcf import to_mjcf
from mbkf.numerics.cardan import quaternion_matrices


def write_result_mjcf(r: Reconstruction, path: str | Path) -> None:
    """Writes the body with a key for every frame in which it is followed, at the frame's time.

    Args:
        r: The result.
        path: The file, replaced whole or not at all.

    Raises:
        InvalidInput: The body is followed in no frame.
        UnknownName: The subject's body is unknown.
        OSError: The file cannot be written.
    """
    rows = np.flatnonzero(r.tracked & np.isfinite(r.q).all(axis=1))
    if not len(rows):
        raise InvalidInput(f"{path}: nothing to write, the body is followed in no frame")
    model = HumanModel.of(r.subject)
    root = ET.fromstring(to_mjcf(model, r.subject.markers))
    keys = ET.SubElement(root, "keyframe")
    positions, velocities = mujoco_state(model, r.q[rows], r.v[rows])
    for row, position, velocity in zip(rows, positions, velocities, strict=True):
        ET.SubElement(
            keys,
            "key",
            name=f"frame {row + 1}",
            time=f"{r.times_s[row]:.9g}",
            qpos=_numbers(position),
            qvel=_numbers(velocity),
        )
    ET.indent(root)
    text = ET.tostring(root, encoding="unicode")
    write_text(path, f'<?xml version="1.0" encoding="utf-8"?>\n<!-- {MARK} -->\n{text}\n')


def mujoco_state(model: Body, q: Array, v: Array) -> tuple[Array, Array]:
    """(T, n_q) positions and (T, n_v) velocities in MuJoCo's order, of configurations and velocities of the body.

    MuJoCo's quaternions begin with w, and the root's velocity is in the world's axes (:mod:`mbkf.model.mjcf`).

    Args:
        model: The body.
        q: (T, n_q) configurations.
        v: (T, n_v) velocities.
    """
    names = configuration_names(model)
    order = np.arange(len(names))
    for k in (k for k, name in enumerate(names) if name.endswith("_qx")):
        order[k : k + 4] = [k + 3, k, k + 1, k + 2]
    velocity = v.copy()
    turned = quaternion_matrices(q[:, 3:7])
    velocity[:, :3] = np.einsum("tij,tj->ti", turned, v[:, :3])
    return q[:, order], velocity


def _numbers(values: Array) -> str:
    return " ".join(f"{one:.12g}" for one in values)
