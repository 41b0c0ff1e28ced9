"""The thesis's full-body studies (its chapter 4.2 and Table 4.4): every claim beside its measurement, on one page.

Synthetic trials of eight persons with exact truth, and public captures, whose rows are left out where they are missing;
the kinematic filter with inverse dynamics (FCDI), the thesis's FDMC and mbkf's dynamic filter, causal and smoothed,
with one set of settings for all of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from benchmarks.checks import Check, Context, left_out
from benchmarks.dynamic.captures import present
from benchmarks.dynamic.methods import in_parallel
from benchmarks.full_body.accuracy import accuracy_findings, lost_by_fdmc, trial_count
from benchmarks.full_body.beyond import claims_beyond_reach
from benchmarks.full_body.claims import survey_claims
from benchmarks.full_body.drawings import survey_drawings, thesis_drawings
from benchmarks.full_body.filters import FCDI
from benchmarks.full_body.observability import observability_findings
from benchmarks.full_body.occlusion import bands_left_out, measured, occlusion_findings
from benchmarks.full_body.occlusion_drawings import occlusion_drawings
from benchmarks.full_body.persons import PERSONS
from benchmarks.full_body.placement import placement_findings
from benchmarks.full_body.real import captures, real_findings, real_scores
from benchmarks.full_body.single_markers import (
    measure_single_markers,
    single_marker_drawing,
    single_marker_findings,
)
from benchmarks.full_body.speed import measure_speed, real_time_factors, speed_drawing, speed_findings
from benchmarks.full_body.survey import SEEDS, Survey, survey
from benchmarks.full_body.trials import JUMP
from benchmarks.needs import PAGE
from benchmarks.thesis_report.page import Report, Texts


def run(context: Context) -> list[Check]:
    """All studies and the page; with ``quick`` one person by causal filters, and one capture."""
    data, quick = context.data, context.quick
    speed = measure_speed(quick)
    with in_parallel() as mapper:
        found = survey(mapper, quick=quick)
        real = real_scores(data, mapper, quick=quick)
        hidden = measured(data, mapper, quick=quick)
        sliding = measure_single_markers(mapper, quick=quick)
        placed = placement_findings(mapper, quick=quick)
        drawings = list(thesis_drawings(mapper, (JUMP,)) if quick else thesis_drawings(mapper))
    parts = [
        accuracy_findings(found),
        occlusion_findings(hidden),
        real_findings(real),
        single_marker_findings(sliding),
        observability_findings(),
        placed,
        speed_findings(speed),
    ]
    bands = [band for part in parts for band in part.bands]
    claims = [
        *survey_claims(found),
        *(claim for part in parts for claim in part.claims),
        *claims_beyond_reach(),
    ]
    sheets = [sheet for part in parts for sheet in part.sheets]
    pictures = [
        *drawings,
        *survey_drawings(found, real),
        *occlusion_drawings(hidden),
        single_marker_drawing(sliding),
        speed_drawing(speed),
    ]
    absent = [*_not_there(data, quick), *(_not_run() if quick else ())]
    Report(_texts(found, absent, quick), quick, bands, claims, sheets, pictures).write(context.out)
    kept = [check for band in bands for check in band.checks(quick)]
    return [*kept, *lost_by_fdmc(found), *real_time_factors(speed), *absent]


def _not_there(data: Path | None, quick: bool) -> Iterator[Check]:
    """Rows of real captures that are missing."""
    note = f"needs captures ({PAGE})"
    for name in bands_left_out(data, quick=quick):
        yield left_out(name, note)
    for name in captures(quick):
        if not present([name], data):
            yield left_out(f"real capture {name}: markers, residual, delay and noise", note)


def _not_run() -> Iterator[Check]:
    """Rows that a quick run leaves out."""
    note = "--quick"
    yield left_out(f"{len(PERSONS) - 1} of {len(PERSONS)} persons", note)
    yield left_out(f"{SEEDS - 1} of {SEEDS} seeds of each movement", note)
    yield left_out("smoothed filters on synthetic trials", note)
    yield left_out("hidden markers: all conditions but one; sliding markers: all but two", note)
    yield left_out("figures 4.4 to 4.14 of the thesis", note)


def _texts(found: Survey, absent: list[Check], quick: bool) -> Texts:
    missing = "; ".join(f"{check.name}: {check.note}" for check in absent)
    return Texts(
        title="Full body: thesis and measurement",
        introduction="Walking, a general movement (reach, one-foot stands, turn, step up), squats, squats with the "
        "knee markers lost, and jumps of eight synthetic persons with exact truth, and public captures, followed by "
        "the kinematic filter with inverse dynamics (FCDI), by the thesis's dynamic filter for the whole body "
        "(FDMC), and by mbkf's dynamic filter. FDMC runs in three forms: as printed, with the covariances of the "
        "thesis's Table 4.3 as densities; per frame, with the same read as what one frame adds, which behaves as the "
        "thesis describes; and ours, with mbkf's noise and force states.",
        trials=(str(trial_count(found, FCDI)), "synthetic trials per filter"),
        command="python -m benchmarks full_body",
        bands="What mbkf's filters have to keep. Splines and rigid-body filling know where a marker is after its gap; "
        "the dynamic filter, frame by frame, does not, and is compared with them all the same.",
        claims="The thesis's statements on whole bodies, and their measurement"
        + (" on one person, one trial of each movement" if quick else ""),
        figures="Truth black, FCDI blue, FDMC per frame violet, FDMC ours green, dynamic orange.",
        remark="The synthetic persons are the filters' own body, so errors of the body itself are left out, but for "
        "the study with a wrong mass." + (f" Left out in this run: {missing}." if missing else ""),
    )
