"""Sensors followed as they come: stand still for two seconds, then turn round in steps, without magnetometers.

The stream is played through the parts of a live run, from its source to the log, as fast as it goes; what each frame
costs is told as a share of the time between frames. Beside it the same sensors as a recording, each frame knowing those
before it only.
"""

from __future__ import annotations

import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, Context
from benchmarks.inertial.body import SAGITTAL
from benchmarks.inertial.motion import RATE_HZ, Case, synthetic
from mbkf.conventions import Array
from mbkf.io.results_folder import read_reconstruction
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.stream.file_source import FileSource
from mbkf.stream.played import played_sensors
from mbkf.stream.run.sensor_standing import SensorStanding
from mbkf.stream.run.session import LiveSession
from mbkf.trial.inertial.motion import InertialMotionSettings, inertial_motion
from mbkf.trial.preparation.settings import ReconstructSettings

SECONDS, STOOD_S, SEEDS = 14.0, 2.0, (0, 1, 2)


def rows(context: Context) -> Iterator[Check]:
    """All of them."""
    for seed in SEEDS[:1] if context.quick else SEEDS:
        case = synthetic("turn", SECONDS, seed)
        name = f"live, no magnetometer, turn of person {seed}"
        q, seconds = _followed(case)
        settings = InertialMotionSettings(smooth=False)
        stood = case.q[round(0.5 * STOOD_S * RATE_HZ)]
        recorded = inertial_motion(
            case.moving, case.subject, standing=(0.0, STOOD_S), posture=stood, settings=settings
        )
        live, causal = _worst(case, q), _worst(case, recorded.result.q)
        yield Check(f"{name}: worst of hip, knee, ankle flexion", live, 4.0, "<=", "deg")
        yield Check(f"{name}: the same of the recording, causal", causal, np.inf, "<=", "deg")
        share = 100.0 * float(np.median(seconds)) * RATE_HZ
        yield Check(f"{name}: computing, share of the time between frames", share, 80.0, "<=", "%")


def _followed(case: Case) -> tuple[Array, Array]:
    """(T, nq) configurations and (T,) computing times, s, of a live run."""
    with tempfile.TemporaryDirectory() as kept:
        folder, stop = Path(kept), threading.Event()
        source = FileSource(played_sensors(case.moving, case.name), 0.0)
        posture = case.q[round(0.5 * STOOD_S * RATE_HZ)]
        model = HumanModel.of(case.subject)
        start = SensorStanding(source, "file", model, folder, lambda _: None, posture=posture)
        start.connect(stop, 1.0)
        found = start.find(stop)
        assert found is not None
        settings = ReconstructSettings(correct_markers=False, checks=False)
        session = LiveSession(found.source, case.subject, settings, folder, "file", found.report, found.worn)
        session.connect(stop, 1.0)
        session.run(stop)
        result = read_reconstruction(folder)
    return np.asarray(result.q), np.asarray(result.step_seconds)


def _worst(case: Case, q: Array) -> float:
    """The largest root mean square error of a flexion, degrees."""
    clinical = ClinicalAngles(HumanModel.of(case.subject))
    chosen = [clinical.names.index(name) for name in SAGITTAL]
    apart = clinical.angles(q)[:, chosen] - clinical.angles(case.q[-len(q) :])[:, chosen]
    return float(np.degrees(np.sqrt((apart**2).mean(axis=0)).max()))
