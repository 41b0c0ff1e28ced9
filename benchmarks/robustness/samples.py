"""Undamaged files of every format that mbkf reads, made by itself from a synthetic walk or from random numbers."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pyarrow as pa
import scipy.io

from benchmarks.any_capture.dialects import (
    TrueCapture,
    TruePlate,
    write_cortex,
    write_devices_table,
    write_motive,
    write_plate_tables,
    write_qualisys,
)
from benchmarks.inertial import makers, makers_binary
from mbkf.conventions import data_folder
from mbkf.io.capture import read_capture, write_capture
from mbkf.io.frame_log import FrameLogWriter
from mbkf.io.imu.mount import ImuMount, write_mounts
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.imu.write import write_imu_csv
from mbkf.io.norms import Band, Norms, write_norms
from mbkf.io.records import MarkerTrajectories
from mbkf.io.results_folder import write_reconstruction
from mbkf.study.batch.curves import SCHEMA, write_curves_table
from mbkf.study.batch.inputs import write_record
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.results.summary import summarise
from mbkf.trial.synth import synthesise, write_folder

SECONDS = 1.0
PLATES_HZ, SAMPLES, FRAMES = 500.0, 100, 20
IMU_HZ, IMU_SAMPLES = 100.0, 60
LAST = "mounts.toml"
"""The file that is made last."""

OSIM = """<?xml version="1.0" encoding="UTF-8" ?><OpenSimDocument Version="40000"><Model name="made"><BodySet><objects>
<Body name="pelvis"><mass>1</mass></Body><Body name="femur_r"><mass>1</mass></Body></objects></BodySet>
<JointSet><objects><CustomJoint name="hip_r"><socket_parent_frame>pelvis_offset</socket_parent_frame>
<socket_child_frame>femur_r_offset</socket_child_frame><frames>
<PhysicalOffsetFrame name="pelvis_offset"><socket_parent>/bodyset/pelvis</socket_parent>
<translation>-0.07 -0.07 0.08</translation><orientation>0 0 0</orientation></PhysicalOffsetFrame>
<PhysicalOffsetFrame name="femur_r_offset"><socket_parent>/bodyset/femur_r</socket_parent>
<translation>0 0 0</translation><orientation>0 0 0</orientation></PhysicalOffsetFrame></frames>
<SpatialTransform><TransformAxis name="rotation1"><coordinates>hip</coordinates><axis>0 0 1</axis>
<LinearFunction name="function"><coefficients>1 0</coefficients></LinearFunction></TransformAxis>
<TransformAxis name="translation1"><coordinates>hip</coordinates><axis>1 0 0</axis><SimmSpline name="function">
<x>-1 0 1</x><y>0.1 0.2 0.1</y></SimmSpline></TransformAxis></SpatialTransform></CustomJoint></objects></JointSet>
<MarkerSet name="set"><objects>
<Marker name="RASI"><socket_parent_frame>/bodyset/pelvis</socket_parent_frame><location> 0.02 0.03 0.12 </location>
<fixed>false</fixed></Marker>
<Marker name="RKNE"><socket_parent_frame>/bodyset/femur_r</socket_parent_frame><location> 0 -0.4 0.05 </location>
<fixed>true</fixed></Marker></objects></MarkerSet></Model></OpenSimDocument>
"""

MAPPING = """<?xml version="1.0" encoding="UTF-8" ?><OpenSimDocument Version="40000"><XsensDataReaderSettings>
<ExperimentalSensors><ExperimentalSensor name="_00B421E6"><name_in_model>pelvis_imu</name_in_model></ExperimentalSensor>
</ExperimentalSensors></XsensDataReaderSettings></OpenSimDocument>
"""


def make_samples(folder: Path) -> None:
    """Makes all files in a folder."""
    _walk(folder)
    _settings(folder)
    _laboratories(folder)
    _sensors(folder)


def _walk(folder: Path) -> None:
    """A capture, its person, truth and results, the log of a run."""
    person, made = synthesise("walk", seconds=SECONDS)
    write_folder(person, made, folder)
    capture = read_capture(folder / "trial.c3d")
    write_capture(capture, folder / "trial.trc")
    result = reconstruct(capture, person)
    write_reconstruction(result, summarise(result), folder / "result")
    write_curves_table(_curves(), folder / "result" / "curves.parquet")
    rows = np.zeros(50, dtype=np.dtype([("frame", "<i8"), ("q", "<f8", (7,))]))
    with FrameLogWriter(folder / "frames.log", rows.dtype, {"subject": "P"}) as log:
        log.append(rows)


def _curves() -> pa.Table:
    """Curves of a cycle, as a batch keeps them, with words and numbers in every column."""
    numbers = pa.array(np.arange(101.0))
    columns = [
        pa.array(["word"] * 101) if pa.types.is_dictionary(field.type) else numbers for field in SCHEMA
    ]
    return pa.table(columns, names=SCHEMA.names).cast(SCHEMA)


def _settings(folder: Path) -> None:
    """Protocol, body, preset, lists and records."""
    shutil.copy(data_folder("markers") / "reference36.toml", folder / "set.toml")
    shutil.copy(data_folder("models") / "human18.toml", folder / "body.toml")
    (folder / "own.toml").write_text(
        'name = "own"\nfilter = "dynamic"\ntuned_on = ["a"]\n[values]\ngate = 5.0\n[found]\ngate = 4.0\n'
    )
    (folder / "list.toml").write_text('[[subject]]\nname = "P"\nmass_kg = 70.0\ntrials = ["trial.c3d"]\n')
    (folder / "list.csv").write_text(
        "subject,session,trial,static,forces,mass_kg\nP,,trial.c3d,static.c3d,,70\n"
    )
    session = folder / "study" / "P01"
    session.mkdir(parents=True, exist_ok=True)
    (session / "session.toml").write_text(
        'mass_kg = 71.5\nheight_m = 1.78\nprotocol = "reference36"\nnote = "x"\n'
    )
    curve, number = Band("deg", 3, np.linspace(0.0, 60.0, 101), np.full(101, 4.0)), np.array([1.2])
    bands = Norms(
        "ours", {("walk", "angle", "knee_angle"): curve}, {("walk", "Speed"): Band("m/s", 3, number, number)}
    )
    write_norms(bands, folder / "norms.toml")
    write_record(folder / "batch.json", {"files": {"a.c3d": "0f"}, "settings": {"a": [1]}, "version": "1"})
    (folder / "labels.json").write_text(json.dumps({"ghosts_dropped": 0, "labels": {"a": [1.0, None]}}))


def _laboratories(folder: Path) -> None:
    """Files as laboratories' programs and OpenSim write them."""
    rng = np.random.default_rng(1)
    positions = (
        rng.uniform(-0.8, 0.8, (6, 3)) + np.linspace(0.0, 0.5, FRAMES)[:, None, None] + [0.0, 0.0, 1.0]
    )
    phase = np.linspace(0.0, 1.0, SAMPLES)
    corners = np.array([[0.3, -0.2, 0.0], [-0.3, -0.2, 0.0], [-0.3, 0.2, 0.0], [0.3, 0.2, 0.0]])  # z down
    force = np.outer(np.sin(np.pi * phase), [40.0, 20.0, 750.0])
    point = np.column_stack([0.2 * phase - 0.1, 0.02 * phase, np.zeros(SAMPLES)])
    plates = tuple(
        TruePlate(corners + shift, force, point + shift, phase)
        for shift in 0.7 * np.eye(3)[[2, 0]] * [1.0, 1.0, 0.0]
    )
    true = TrueCapture(
        MarkerTrajectories(tuple("ABCDEF"), positions, PLATES_HZ * FRAMES / SAMPLES), plates, PLATES_HZ
    )
    write_motive(true, folder / "motive.csv")
    write_qualisys(true, folder / "qualisys.tsv", in_plate_axes=True, with_times=True)
    write_cortex(true, folder / "cortex.forces", "y")
    write_devices_table(true, folder / "devices.csv")
    (folder / "plates").mkdir(exist_ok=True)
    write_plate_tables(true, folder / "plates")
    (folder / "model.osim").write_text(OSIM)


def _sensors(folder: Path) -> None:
    """Inertial readings in every form, and where sensors sit."""
    rng = np.random.default_rng(2)
    times = np.arange(IMU_SAMPLES) / IMU_HZ
    force, rate, field = (rng.normal(size=(IMU_SAMPLES, 3)) for _ in range(3))
    turns = rng.normal(size=(IMU_SAMPLES, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    write_imu_csv([ImuReadings("foot", times, force, rate, field, IMU_HZ, "own", turns)], folder / "made.csv")
    broad = {"imu_acc": force, "imu_gyr": rate, "imu_mag": field, "opt_quat": turns, "sampling_rate": IMU_HZ}
    scipy.io.savemat(folder / "broad.mat", broad)
    scipy.io.savemat(folder / "packed.mat", broad, do_compression=True)
    segment = {"acc": force, "gyr": rate, "quat": turns}
    scipy.io.savemat(folder / "qmt.mat", {"t": times, "hip": segment, "foot": segment})
    titles = "PacketCounter\tAcc_X\tAcc_Y\tAcc_Z\tGyr_X\tGyr_Y\tGyr_Z\tQuat_q0\tQuat_q1\tQuat_q2\tQuat_q3"
    rows = np.column_stack([(65500 + np.arange(IMU_SAMPLES)) % 65536, force, rate, turns])
    lines = ["\t".join(f"{value:.6g}" for value in row) for row in rows]
    place = folder / "xsens"
    place.mkdir(exist_ok=True)
    text = "\n".join(["// Start Time: Unknown", "// Update Rate: 100.0Hz", titles, *lines])
    (place / "MT_00B421E6.txt").write_text(text + "\n")
    (place / "mapping.xml").write_text(MAPPING)
    made, left = folder / "makers", makers.truth("left_foot", 1, samples=IMU_SAMPLES)
    made.mkdir(exist_ok=True)
    for write in (makers.movella_dot, makers.shimmer):
        write(left, made)
    makers.phyphox(left, made, form="zip")
    makers.delsys((left,), made)
    for write_all in (makers_binary.mvnx, makers_binary.xdf, makers_binary.c3d):
        write_all((left,), made)
    mount = ImuMount("foot", "foot_r", np.array([0.1, 0.0, 0.0]), np.array([0.0, 0.0, 0.0, 1.0]))
    write_mounts([mount], folder / LAST)
