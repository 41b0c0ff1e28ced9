"""Errors of the filters by movement, lost trials, and the bounds on jumps and on the squat with lost markers."""

from __future__ import annotations

from collections.abc import Sequence

from benchmarks.checks import Check, information
from benchmarks.full_body.filters import CAUSAL, DYNAMIC, FCDI, FDMC, FDMC_PER_FRAME, FDMC_PRINTED, SMOOTHED
from benchmarks.full_body.persons import PERSONS
from benchmarks.full_body.scores import DIVERGED_DEG
from benchmarks.full_body.survey import Survey
from benchmarks.full_body.trials import JUMP, LOST, MOVEMENTS, SQUAT, VARIANTS
from benchmarks.thesis_report.contents import OPEN, Band, Findings, Row, Sheet

JUMP_BOUNDS = (("torque_nm", "torque", 0.8), ("velocity_rad_s", "velocity", 0.7), ("angle_deg", "angle", 1.0))
KNEE_BOUND = 0.5

ALL = (*CAUSAL, *SMOOTHED)

ERRORS = (
    ("angle_deg", "angles (°)"),
    ("velocity_rad_s", "velocities (rad/s)"),
    ("torque_nm", "torques (N m)"),
    ("reaction_n", "reactions (N)"),
    ("marker_mm", "markers (mm)"),
)
CURVES = (
    ("velocity_delay_ms", "velocity delay (ms)"),
    ("torque_delay_ms", "torque delay (ms)"),
    ("velocity_noise_rad_s", "velocity noise (rad/s)"),
    ("torque_noise_nm", "torque noise (N m)"),
)
LAW = (
    ("residual_before_n", "residual before (N)"),
    ("residual_n", "residual after (N)"),
    ("residual_everywhere_n", "after, all frames (N)"),
    ("nis", "NIS per reading"),
)
KNEE = (
    ("knee_deg", "knee at the worst (°)"),
    ("flexion_deg", "its flexion alone (°)"),
    ("knee_torque_nm", "flexion torque (N m)"),
    ("knee_lateral_nm", "lateral torque (N m)"),
)


def accuracy_findings(found: Survey) -> Findings:
    """Bands and tables of the synthetic trials."""
    return Findings(
        bands=[*_divergence_bands(found), *_jump_bands(found), _knee_band(found)],
        sheets=[
            divergence_sheet(found),
            _sheet(
                found, "errors", "Errors against the truth", ERRORS, (*MOVEMENTS, *VARIANTS), _ERRORS_NOTE
            ),
            _sheet(
                found,
                "delay_and_noise",
                "Delay and noise of the legs' curves",
                CURVES,
                MOVEMENTS,
                _CURVES_NOTE,
            ),
            _sheet(
                found,
                "residual_and_innovation",
                "What Newton's law lacks, and innovation",
                LAW,
                (*MOVEMENTS, *VARIANTS),
                _LAW_NOTE,
            ),
            _sheet(
                found,
                "knee_markers_lost",
                "Squat with and without the knee markers",
                KNEE,
                (SQUAT, LOST),
                _KNEE_NOTE,
            ),
            persons_sheet(found),
        ],
    )


_ERRORS_NOTE = (
    "RMS over joints, frames and trials that the filter did not lose; posture in the tangent space, reactions per "
    "component of the feet's forces, markers from the body where they were seen."
)
_CURVES_NOTE = (
    "Delay: the shift that leaves the least difference from the truth, mean over trials. Noise: RMS of the error above "
    "6 Hz. Hips, knees and ankles."
)
_LAW_NOTE = (
    "RMS of the force that Newton's law lacks with the measured plates. Before: in the motion predicted from the frame "
    "before. After: in the estimate; without the frames in which a loaded foot stands beside the plates, and with them."
)
_KNEE_NOTE = (
    "The 100 frames about the deepest bend of the right knee. Knee at the worst: largest angle of the rotation between "
    "estimated and true knee, mean over trials. Torques: RMS in the gap and half a second after."
)


def _divergence_bands(found: Survey) -> list[Band]:
    row = f"divergences, {trial_count(found, FCDI)} trials"
    return [
        Band(row, name, float(lost_trials(found, name)), -OPEN, 0.0, "", False) for name in (FCDI, DYNAMIC)
    ]


def lost_by_fdmc(found: Survey) -> list[Check]:
    """How many trials each form of FDMC lost, for information."""
    return [
        information(
            f"divergences of {name}, of {trial_count(found, name)} trials", float(lost_trials(found, name))
        )
        for name in (FDMC_PRINTED, FDMC_PER_FRAME, FDMC)
    ]


def lost_trials(found: Survey, name: str) -> int:
    """Trials of the five movements that a filter lost."""
    return sum(found.divergences(name, movement) for movement in MOVEMENTS)


def trial_count(found: Survey, name: str, movements: Sequence[str] = MOVEMENTS) -> int:
    """Trials on which a filter was run.

    Args:
        found: All outcomes.
        name: Name of the filter.
        movements: The movements that count.
    """
    return sum(len(found.of(name, movement)) for movement in movements)


def _jump_bands(found: Survey) -> list[Band]:
    others = [name for name in (FCDI, FDMC, FDMC_PER_FRAME) if found.of(name, JUMP)]
    return [
        Band(
            "jump",
            f"dynamic over the best of FCDI and FDMC: {word}",
            _least(found, others, number),
            -OPEN,
            bound,
        )
        for number, word, bound in JUMP_BOUNDS
    ]


def _least(found: Survey, others: Sequence[str], number: str) -> float:
    """The largest of the dynamic filter's ratios to each of the others, each over the trials that both ran."""
    return max(found.ratio(DYNAMIC, [name], JUMP, number) for name in others)


def _knee_band(found: Survey) -> Band:
    value = found.ratio(DYNAMIC, [FCDI], LOST, "knee_deg")
    return Band("squat, knee markers lost", "knee at the worst, dynamic over FCDI", value, -OPEN, KNEE_BOUND)


def divergence_sheet(found: Survey) -> Sheet:
    """Trials that each filter lost, by movement."""
    rows: list[Row] = []
    for name in ALL:
        cells = [
            f"{found.divergences(name, movement)} of {len(found.of(name, movement))}"
            for movement in MOVEMENTS
        ]
        rows.append((name, *cells, f"{lost_trials(found, name)} of {trial_count(found, name)}"))
    note = (
        f"Lost: RMS error of the angles above {DIVERGED_DEG:g}°, or numbers that are not finite. One set of "
        "covariances for all persons and movements. Filters that lose nothing ran on fewer seeds, smoothed ones on "
        "every second person."
    )
    return Sheet("divergences", "Lost trials", ("filter", *MOVEMENTS, "in all"), tuple(rows), note)


def _sheet(
    found: Survey,
    name: str,
    title: str,
    numbers: Sequence[tuple[str, str]],
    movements: Sequence[str],
    note: str,
) -> Sheet:
    """One row per movement and filter, one column per number.

    Args:
        found: All outcomes.
        name: Of the file.
        title: Of the table.
        numbers: Pairs of a field of the scores and its heading.
        movements: The movements.
        note: Remarks for the reader.
    """
    rows: list[Row] = [
        (
            movement,
            filter_name,
            str(len(found.of(filter_name, movement)) - found.divergences(filter_name, movement)),
            *(found.pooled(filter_name, movement, number) for number, _ in numbers),
        )
        for movement in movements
        for filter_name in ALL
        if found.of(filter_name, movement)
    ]
    return Sheet(
        name, title, ("movement", "filter", "trials", *(head for _, head in numbers)), tuple(rows), note
    )


def persons_sheet(found: Survey) -> Sheet:
    """Torque errors of every person, FCDI and dynamic, by movement."""
    names = (FCDI, DYNAMIC)
    rows: list[Row] = []
    for number, person in enumerate(PERSONS):
        own = Survey([one for one in found.outcomes if one.person == number])
        if own.outcomes:
            rows.append(
                (
                    person.label,
                    f"{person.height_m:.2f}",
                    *(own.pooled(name, movement, "torque_nm") for movement in MOVEMENTS for name in names),
                )
            )
    heads = [f"{movement}: {name}" for movement in MOVEMENTS for name in names]
    return Sheet(
        "persons",
        "Torque errors by person (N m)",
        ("person", "height (m)", *heads),
        tuple(rows),
        "Four women (W) and four men (M) with age and mass; the same settings for all of them.",
    )
