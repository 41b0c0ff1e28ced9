"""Small inputs of faulty kinds against their right answers: captures, inertial files, a hand-over and a study."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.checks import Check, within
from benchmarks.commands import Ended, typed
from benchmarks.strangers.shared_captures import ANKLE_DEG, standing_ankles_deg
from mbkf.imu.orientation import OrientSettings, orientations
from mbkf.io.capture import read_capture
from mbkf.io.imu.files import read_imu
from mbkf.io.results_folder import read_summary
from mbkf.io.storage import read_storage

FOLDER = "strangers3"
TRC = (
    "t1_names_single_tab", "t2_labels_not_sequential", "t3_seven_keys", "t4_space_aligned", "t4b_space_names_only",
    "t5_header_rows_more_than_data", "t6_cr", "t6_crlf", "t7_decimal_comma", "t8_no_blank_line", "t9_prefix",
    "t10_no_units",
)  # fmt: skip
"""Dialects of ``t0_reference.trc``."""

CLIP_RAD_S, CLIP_BOUND = 7.35, 0.02
"""Where the gyroscope of the soft saturation clips, rad/s, and a relative error that a plateau of one hundredth and the
offset of a gyroscope explain."""

MAKERS: dict[str, tuple[str, tuple[str, ...], float]] = {
    "apdm_motion_studio_60rows.csv": ("APDM", ("Static", "Upper", "Middle", "Lower"), 128.0),
    "xsens_sample_rate_header_100rows.txt": ("Xsens", ("xsens_sample_rate_header_100rows",), 50.0),
    "repoimu_two_row_header_TStick05_12s.csv": ("RepoIMU", ("IMU",), 100.0),
    "ms_rounded_clock_163Hz.csv": ("stamps in whole ms", ("ms_rounded_clock_163Hz",), 163.2),
    "xio_short_walk_buffered_stamps_15s.csv": (
        "buffered stamps",
        ("xio_short_walk_buffered_stamps_15s",),
        397.7,
    ),
}
"""Inertial files: title, names of the sensors, and rate in Hz."""

RATE_BOUND = 0.002
"""Largest relative error of a rate."""

PELVIS_M, PELVIS_BOUND_M = 0.975, 0.03
"""Mean height of OpenSim's pelvis from 0.45 to 1.80 s in the reference of the Rajagopal walk, whose own markers of the
ASIS lie 35 mm above that pelvis's origin; nearer than 30 mm the reference does not state it."""

CHILDREN = {"HC032A": 60.3, "HC044A": 39.4}
"""Persons of one folder and their masses by the files, kg."""

HIP_NM = (27.2 * 0.85, 27.2 * 1.15)
"""Peak of the lighter child's hip moment; with the other's body it was 54.4 N m."""


def small_input_rows(data: Path, out: Path) -> Iterator[Check]:
    """Rows of all small inputs.

    Args:
        data: Folder of the reference captures.
        out: Folder for results.
    """
    yield from marker_table_rows(data / FOLDER)
    yield from heel_cluster_rows(data / FOLDER, out)
    yield from person_rows(data / FOLDER, out)
    yield from maker_rows(data / FOLDER, out)
    yield from saturation_rows(data / FOLDER, out)
    yield from lower_back_rows(data / FOLDER, out)
    yield from hand_over_rows(data / "rajagopal_walk_run", out)
    yield from children_rows(data / "biomechzoo_walk_turn", out)


def marker_table_rows(folder: Path) -> Iterator[Check]:
    """Dialects of one TRC file: markers that differ from those of the reference in name or place."""
    right = read_capture(folder / "t0_reference.trc").markers
    wrong = 0
    for name in TRC:
        ended = typed("info", folder / f"{name}.trc", "--json")
        same = ended.code == 0
        if same:
            found = read_capture(folder / f"{name}.trc").markers
            same = found.names == right.names and np.allclose(
                found.positions_m, right.positions_m, atol=1e-6, equal_nan=True
            )
        wrong += not same
    yield Check(f"{len(TRC)} dialects of one TRC file, read otherwise", wrong, 0, "<=")
    found_set = json.loads(typed("info", folder / "one_person_prefix.trc", "--json").out)["protocol"]
    yield _yes(
        "a subject's name before the markers: plug_in_gait, 37 of 41",
        "plug_in_gait knows 37 of 41 markers" in str(found_set["told"]),
    )


def heel_cluster_rows(folder: Path, out: Path) -> Iterator[Check]:
    """Clusters at the heels alone: angles of the standing ankles."""
    subject = out / "heels.toml"
    ended = typed("scale", folder / "clusters_heel_only.trc", "--mass", "70", "--out", subject)
    yield _done("clusters at the heels: scaled", ended)
    for side, angle in zip(("right", "left"), standing_ankles_deg(subject), strict=True):
        yield from within(f"clusters at the heels: {side} ankle", angle, *ANKLE_DEG, "°")


def person_rows(folder: Path, out: Path) -> Iterator[Check]:
    """Two persons in one file: reported, refused as one body, and one of them scaled where it is chosen."""
    for name, chosen in (("two_persons_pig", "A"), ("two_persons_no_prefix", "1")):
        path = folder / f"{name}.trc"
        yield _yes(f"{name}: two persons are reported", "2 persons" in typed("info", path).text)
        asked: list[str | Path] = ["scale", "--trial", path, "--mass", "70", "--out", out / f"{name}.toml"]
        yield _yes(f"{name}: refused without a choice", typed(*asked).code == 2)
        yield _done(f"{name}: --person {chosen} is scaled", typed(*asked, "--person", chosen))


def maker_rows(folder: Path, out: Path) -> Iterator[Check]:
    """Inertial files without options: oriented, sensors and rates; a rate that is given holds."""
    for file, (title, names, rate_hz) in MAKERS.items():
        ended = typed("imu", "orient", folder / file, "--frame", "NWU", "--out", out / Path(file).stem)
        yield _done(f"{title}: oriented without options", ended)
        sensors = read_imu(folder / file)
        yield _yes(f"{title}: sensors", tuple(one.name for one in sensors) == names)
        off = max(abs(one.rate_hz / rate_hz - 1.0) for one in sensors)
        yield Check(f"{title}: rate of {rate_hz:g} Hz, relative error", off, RATE_BOUND, "<=")
    (stated,) = read_imu(folder / "xio_short_walk_buffered_stamps_15s.csv", rate_hz=400.0)
    yield _yes("buffered stamps: --rate 400 holds", stated.rate_hz == 400.0)


def saturation_rows(folder: Path, out: Path) -> Iterator[Check]:
    """A gyroscope that clips softly: reported with limit and share, and spreads that hold the error of the tilt.

    The noise by which spreads are widened was chosen on the trial of the last row.
    """
    file = folder / "gyro_soft_saturation_TStick05_30s_flat.csv"
    said = typed("imu", "orient", file, "--frame", "NWU", "--out", out / "soft").text
    text = " ".join(said.split())
    limits = [float(word) for word in re.findall(r"clips softly at -?([0-9.]+) deg/s", text)]
    off = max((abs(np.radians(one) / CLIP_RAD_S - 1.0) for one in limits), default=np.nan)
    yield Check("soft saturation: reported limit, relative error", off, CLIP_BOUND, "<=")
    yield _yes("soft saturation: reported with its share", "clips softly" in text and "%;" in text)
    (trial,) = read_imu(folder / "repoimu_two_row_header_TStick05_12s.csv")
    (course,) = orientations([trial], frame="NWU", settings=OrientSettings("smooth"))
    name = "soft saturation: tilt of the trial chosen on"
    if trial.orientation is None or course.sd_rad is None:
        yield Check(f"{name}, error over standard deviation", np.nan, 1.5, "<=")
        return
    up = Rotation.from_quat(trial.orientation).inv().apply([0.0, 0.0, 1.0])
    off = Rotation.from_quat(course.quaternion).apply(up)[:, :2]
    ratio = np.sqrt((off**2).mean() / (course.sd_rad[:, :2] ** 2).mean())
    yield from within(f"{name}, error over standard deviation", float(ratio), 0.5, 1.5)


def lower_back_rows(folder: Path, out: Path) -> Iterator[Check]:
    """A sensor on the lower back, whose steps are no strides of a foot."""
    options = ("--units", "acc=g,gyr=deg/s", "--rate", "100", "--out", out / "strides")
    ended = typed("imu", "stride", folder / "lower_back_sensor_60s.csv", *options)
    yield _yes(
        "a lower back in imu stride: refused with its reason",
        ended.code == 2 and "worn elsewhere" in ended.err,
    )


def hand_over_rows(folder: Path, out: Path) -> Iterator[Check]:
    """OpenSim's pelvis in ``angles.mot`` against the reference of the Rajagopal walk."""
    subject, result = out / "rajagopal.toml", out / "rajagopal"
    typed("scale", folder / "static_walk_1.trc", "--mass", "85.07", "--out", subject)
    forces = ("--forces", folder / "grf_walk.mot")
    typed("reconstruct", folder / "motion_capture_walk.trc", "--subject", subject, *forces, "--out", result)
    table = read_storage(result / "angles.mot")
    there = (table.times_s >= 0.45) & (table.times_s <= 1.80)
    off = abs(float(table.column("pelvis_ty")[there].mean()) - PELVIS_M)
    yield Check("hand-over to OpenSim: mean pelvis_ty off 0.975 m", off, PELVIS_BOUND_M, "<=", "m")


def children_rows(folder: Path, out: Path) -> Iterator[Check]:
    """Two children in one folder: each one's own mass, and the lighter one's hip moment."""
    study = out / "children"
    study.mkdir()
    for name in CHILDREN:
        for path in sorted(folder.glob(f"{name}_St*.c3d")):
            shutil.copyfile(path, study / path.name)
    yield _done("two children in one folder: batch", typed("batch", study, "--out", out / "children_out"))
    found = {name: sorted((out / "children_out" / name).glob("*/summary.json")) for name in CHILDREN}
    summaries = {name: read_summary(paths[0].parent) for name, paths in found.items() if paths}
    own = sum(summaries[name]["mass_kg"] == kg for name, kg in CHILDREN.items() if name in summaries)
    yield Check("two children in one folder: results with the own mass", own, len(CHILDREN), ">=")
    lighter = summaries.get("HC044A")
    peaks = [] if lighter is None else [lighter["torque_peak_nm_per_kg"][f"hip_{side}"] for side in "rl"]
    largest = max((abs(one) for one in peaks if one is not None), default=np.nan) * CHILDREN["HC044A"]
    yield from within("two children in one folder: hip moment of the lighter", largest, *HIP_NM, "N m")


def _yes(name: str, value: bool) -> Check:
    return Check(name, float(value), 1.0, ">=")


def _done(name: str, ended: Ended) -> Check:
    return Check(f"{name}, exit code", ended.code, 0, "<=")
