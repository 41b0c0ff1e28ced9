"""Local marker correction on the trial itself (thesis 4.1.1): markers sit a little elsewhere in every session.

Skin shifts between standing with spread arms and walking, markers fall off and are stuck on again. With the scale
factors fixed, each marker's offset in its segment is found anew over frames of the whole trial, near where the subject
file has it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.io.records import MarkerTrajectories
from mbkf.io.subject import Subject, SubjectMarker
from mbkf.model.description import load_body
from mbkf.model.protocol import Protocol, ProtocolMarker
from mbkf.numerics.levenberg_marquardt import minimise
from mbkf.scaling.frames import choose_frames
from mbkf.scaling.problem import ScalingPrior, ScalingProblem
from mbkf.sensors.pose_fit import segment_by_segment

FRAMES = 40
LOOKS = 10.0
"""How many independent looks at a marker the frames of one trial are worth (skin moves slowly)."""

POSTURE_LOOKS = 20.0
"""The same for the posture; it keeps a knee from taking the skin's sideways movement for its own."""

FIXED_FACTOR_SD = 1e-5


def correct_markers(subject: Subject, trial: MarkerTrajectories) -> Subject:
    """The subject with marker positions as this trial has them; markers not in the trial keep theirs.

    Args:
        subject: A scaled subject.
        trial: Markers under the subject's own names.

    Raises:
        NotObservable: Too few of the subject's markers are in the trial.
    """
    body = load_body(subject.body)
    factors = np.array([subject.scale_factors.get(name, 1.0) for name in body.scale_factors])
    own = tuple(_as_protocol_marker(marker) for marker in subject.markers)
    frames = choose_frames([trial], Protocol(subject.protocol, subject.protocol, body.name, own), FRAMES)
    local = np.array([m.position_m for m in frames.markers])
    scaled = np.array([body.segment(m.segment).scale_matrix @ factors for m in frames.markers])
    markers = tuple(
        replace(m, position_m=p / s) for m, p, s in zip(frames.markers, local, scaled, strict=True)
    )
    prior = ScalingPrior(
        factors=factors,
        factor_covariance=FIXED_FACTOR_SD**2 * np.eye(len(factors)),
        offsets_m=np.zeros_like(local),
        placement_sd_m=np.array([m.placement_sd_m for m in markers]),
    )
    count = len(frames.measured_m)
    share = min(1.0, LOOKS / count)
    markers = tuple(replace(m, noise_m=m.noise_m / np.sqrt(share)) for m in markers)
    weight = np.full(count, min(1.0, POSTURE_LOOKS / count))
    problem = ScalingProblem(body, markers, frames.measured_m, weight, prior)
    sensor = problem.sensor(problem.start(np.zeros((0, problem.posture.model.nq))))
    start = problem.start(np.array([segment_by_segment(sensor, frame) for frame in frames.measured_m]))
    state = minimise(start, problem.linearise, problem.cost, problem.move, tolerance=1e-3).state
    moved: dict[str, Array] = {
        m.name: problem.local_m(state.factors, state.offsets_m)[i] for i, m in enumerate(markers)
    }
    return replace(
        subject,
        markers=tuple(replace(m, position_m=moved.get(m.name, m.position_m)) for m in subject.markers),
    )


def _as_protocol_marker(marker: SubjectMarker) -> ProtocolMarker:
    return ProtocolMarker(
        marker.name, marker.segment, marker.position_m, "technical", marker.session_sd_m, marker.noise_m
    )
