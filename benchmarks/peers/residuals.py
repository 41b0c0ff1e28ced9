"""Force that is missing at the pelvis: how far motion and plates are from Newton's law, by each tool."""

from __future__ import annotations

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.dynamic.captures import Person, withheld_left
from benchmarks.peers import biorbd_tool, opensim_id
from benchmarks.peers.biorbd_tool import Motion
from benchmarks.peers.results import SMOOTH, Results
from benchmarks.references import low_pass, rms
from mbkf.conventions import Array, BoolArray
from mbkf.numerics.threads import single_threaded
from mbkf.trial.checks.evidence import Evidence
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.markers_alone import markers_alone
from mbkf.trial.preparation.selection import subject_markers
from mbkf.trial.preparation.settings import ReconstructSettings

CUT_OFFS_HZ = (4.0, 5.0, 6.0, 8.0, 10.0, 12.0)
"""Cut-offs of low-passes among which every tool's best is taken; 6 Hz is what OpenSim's examples use."""

BEFORE, AFTER = 1.0, 0.2


def residual_rows(found: Results, bounded: bool) -> list[Check]:
    """Residual forces, and ours over the better peer's at its best low-pass.

    Args:
        found: What the tools make of a capture.
        bounded: Whether the ratios have bounds.
    """
    own, rate_hz = evidence(found), found.shared.rate_hz
    judged = own.clear & found.smooth.measured
    asked, given = own.asked[:, :3], own.total[:, :3]
    known = np.flatnonzero(np.isfinite(asked).all(axis=1))
    inside = slice(known[0], known[-1] + 1)
    filtered_ours = {}
    for hz in CUT_OFFS_HZ:
        smooth = asked.copy()
        smooth[inside] = low_pass(asked[inside], rate_hz, hz)
        filtered_ours[hz] = norm_rms((smooth - given)[judged])
    theirs = {"OpenSim": opensim_residuals(found), "biorbd": biorbd_residuals(found)}
    best = {tool: min(norm_rms(force[judged]) for force in some) for tool, some in theirs.items()}
    better, plain = min(best.values()), norm_rms((asked - given)[judged])
    alike = min(filtered_ours.values())
    after = norm_rms(found.smooth.residual_force_n[judged])
    before_bound, after_bound = (BEFORE, AFTER) if bounded else (np.inf, np.inf)
    label = f"{found.shared.name}: residual force"
    return [
        information(f"{label}, frames judged", float(judged.sum())),
        information(f"{label}, mbkf before correction, no low-pass", plain, "N"),
        information(f"{label}, mbkf before correction, at its best low-pass", alike, "N"),
        information(f"{label}, mbkf causal", norm_rms(found.causal.residual_force_n[judged]), "N"),
        information(f"{label}, mbkf smoothed", after, "N"),
        *(
            information(f"{label}, {tool} at its best low-pass, offline", value, "N")
            for tool, value in best.items()
        ),
        information(f"{label}, biorbd causal", _causal(found, judged), "N"),
        Check(
            f"{label}, before correction / better peer, low-passed alike", alike / better, before_bound, "<="
        ),
        Check(f"{label}, the same, ours without any low-pass", plain / better, before_bound, "<="),
        Check(f"{label}, after correction / better peer", after / better, after_bound, "<="),
    ]


def withheld_row(found: Results) -> Check:
    """The force that mbkf finds under the left foot without its plate, against that plate."""
    person = Person(found.shared.name, found.shared.person.capture, found.subject)
    error = withheld_left(person, SMOOTH).rms_n
    return information(f"{person.name}: vertical force of the withheld left plate, mbkf smoothed", error, "N")


def evidence(found: Results) -> Evidence:
    """Motion by mbkf from markers alone beside the plates, before anything is corrected."""
    capture, subject = found.shared.person.capture, found.subject
    with single_threaded():
        measured = subject_markers(capture.markers, subject)
        inputs, recording = trial_inputs(measured, capture.plates, subject, ReconstructSettings())
        motion = markers_alone(inputs, recording, None)
        return Evidence.of(inputs.sensor.model, motion, measured.times_s, measured.rate_hz, inputs.plates)


def opensim_residuals(found: Results) -> list[Array]:
    """(T, 3) OpenSim's force at the pelvis, N, of every body and low-pass."""
    own, forces = found.shared, []
    for toes, motion in found.opensim.items():
        for hz in CUT_OFFS_HZ:
            table = opensim_id.inverse_dynamics(
                found.bodies[toes].model, motion.coordinates, motion.q, own.times_s, own.loads, hz
            )
            forces.append(np.column_stack([table.column(f"pelvis_t{axis}_force") for axis in "xyz"]))
    return forces


def biorbd_residuals(found: Results, cut_offs_hz: tuple[float, ...] = CUT_OFFS_HZ) -> list[Array]:
    """(T, 3) biorbd's force at the pelvis, N, of every body, noise and low-pass of the coordinates.

    Args:
        found: What the tools make of a capture.
        cut_offs_hz: Cut-offs; none for the motion as the filter gives it, which is causal.
    """
    own = found.shared
    models = {toes: biorbd_tool.read(body.body) for toes, body in found.bodies.items()}
    forces = []
    for (toes, _), motion in found.biorbd.items():
        kinds = [filtered(motion, own.rate_hz, hz) for hz in cut_offs_hz] or [motion]
        for one in kinds:
            forces.append(biorbd_tool.inverse_dynamics(models[toes], one, own.times_s, own.loads)[:, :3])
    return forces


def _causal(found: Results, judged: BoolArray) -> float:
    return min(norm_rms(force[judged]) for force in biorbd_residuals(found, ()))


def filtered(motion: Motion, rate_hz: float, cut_off_hz: float) -> Motion:
    """The coordinates low-passed forwards and backwards, and their slopes.

    Args:
        motion: The motion.
        rate_hz: Frame rate.
        cut_off_hz: The low-pass.
    """
    q = low_pass(motion.q, rate_hz, cut_off_hz)
    v = np.gradient(q, 1.0 / rate_hz, axis=0)
    return Motion(q, v, np.gradient(v, 1.0 / rate_hz, axis=0), motion.markers_m)


def norm_rms(vectors: Array) -> float:
    """RMS of the vectors' (T, 3) lengths."""
    return rms(np.linalg.norm(vectors, axis=1))
