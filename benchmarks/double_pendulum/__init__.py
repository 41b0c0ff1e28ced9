"""The thesis's double pendulum: every discretisation and study, with bounds, on the human's own filter code.

Writes tables (CSV), the thesis's figures redrawn, and one page that sets thesis and measurement side by side.
"""

from __future__ import annotations

from benchmarks.checks import Check, Context
from benchmarks.double_pendulum.bodies import body_findings
from benchmarks.double_pendulum.consistency import consistency_findings, measure_consistency
from benchmarks.double_pendulum.drawings import drawings
from benchmarks.double_pendulum.extensions import artefact_findings, own_findings, smoother_findings
from benchmarks.double_pendulum.laboratory import laboratory
from benchmarks.double_pendulum.studies import delay_findings, mass_findings, occlusion_findings
from benchmarks.double_pendulum.sweeps import measure_sweeps, sensor_findings, sweep_findings
from benchmarks.double_pendulum.tables import table_findings
from benchmarks.double_pendulum.thesis import settings_sheet
from benchmarks.thesis_report.page import Report, Texts

SEEDS, QUICK_SEEDS = 100, 2


def run(context: Context) -> list[Check]:
    """Measures everything; with ``quick`` over a few seeds, which show the statistical rows without judging them."""
    seeds = QUICK_SEEDS if context.quick else SEEDS
    with laboratory(seeds, context.quick) as lab:
        sweeps = measure_sweeps(lab)
        consistency = measure_consistency(lab)
        found = [
            body_findings(),
            table_findings(lab),
            delay_findings(lab),
            sweep_findings(sweeps),
            mass_findings(lab),
            occlusion_findings(lab),
            consistency_findings(consistency),
            smoother_findings(lab),
            artefact_findings(lab, sweeps),
            own_findings(lab),
            sensor_findings(lab),
        ]
    bands = [band for part in found for band in part.bands]
    claims = [claim for part in found for claim in part.claims]
    sheets = [settings_sheet(), *(sheet for part in found for sheet in part.sheets)]
    pictures = list(drawings(sweeps, consistency))
    Report(_texts(seeds), context.quick, bands, claims, sheets, pictures).write(context.out)
    return [check for band in bands for check in band.checks(context.quick)]


def _texts(seeds: int) -> Texts:
    return Texts(
        title="Double pendulum: thesis and measurement",
        introduction="Two bars on a force plate, followed by the thesis's dynamic filter (FD, and its light form "
        "FDMC), by a kinematic filter with inverse dynamics (FCDI), and by mbkf's filter in acceleration coordinates. "
        "All run through the human model's own plants, integrators and updates; only the body differs.",
        trials=(str(seeds), "seeds per number"),
        command="python -m benchmarks double_pendulum",
        bands="Intervals that a correct implementation keeps, from the thesis's tables and from theory.",
        claims="The thesis's statements, and the measurements over the seeds",
        figures="Truth black, FCDI blue, FD orange, FDMC green. Over covariances: median of the seeds, shaded from the "
        "10th to the 90th percentile.",
    )
