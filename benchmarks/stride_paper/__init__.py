"""The stride paper redone: its simulated cases and its steps, a verdict per claim, and why drift harms its method only.

Writes tables (CSV), the paper's figures drawn again, and one page with the paper's values beside ours. Real recordings
come from the public captures; without them the simulated part runs alone.
"""

from __future__ import annotations

from benchmarks.checks import Check, Context
from benchmarks.inertial.stride_measured import FOLDER, compare
from benchmarks.stride_paper.cases import case_findings
from benchmarks.stride_paper.choices import choice_findings
from benchmarks.stride_paper.drawings import drawings, measured_drawing
from benchmarks.stride_paper.errors import measure
from benchmarks.stride_paper.reading_findings import reading_findings
from benchmarks.stride_paper.readings import search
from benchmarks.stride_paper.step_findings import step_findings
from benchmarks.stride_paper.steps import estimate, late_starts, recordings, signals
from benchmarks.stride_paper.switches import measure_switches, switch_findings
from benchmarks.thesis_report.page import Report, Texts
from mbkf.numerics.threads import single_threaded

SEEDS, QUICK_SEEDS = 10, 2


def run(context: Context) -> list[Check]:
    """Measures everything; with ``quick`` over a few seeds of the noise."""
    seeds = QUICK_SEEDS if context.quick else SEEDS
    data = context.data if context.data is not None and (context.data / FOLDER).is_dir() else None
    with single_threaded():
        study = measure(range(seeds))
        switched, readings = measure_switches(), search()
        steps = recordings(data)
        compared = [] if data is None else compare(data / FOLDER)
        late = [] if data is None else late_starts([one for one in steps if one.measured], data)
        found = [
            case_findings(study, seeds),
            switch_findings(switched),
            reading_findings(readings),
            choice_findings(seeds),
            step_findings(
                estimate(steps),
                late,
                None if data is None else signals(data, compared),
                compared,
            ),
        ]
        pictures = [
            *drawings(study, switched, readings, steps),
            *(measured_drawing(compared) for _ in compared[:1]),
        ]
    bands = [band for part in found for band in part.bands]
    claims = [claim for part in found for claim in part.claims]
    sheets = [sheet for part in found for sheet in part.sheets]
    Report(_texts(seeds, data is None), context.quick, bands, claims, sheets, pictures).write(context.out)
    return [check for band in bands for check in band.checks(context.quick)]


def _texts(seeds: int, without_captures: bool) -> Texts:
    lacking = (
        " The public captures were not given: measured steps are left out (--data DIR)."
        if without_captures
        else ""
    )
    return Texts(
        title="Stride length from a foot's sensor: paper and measurement",
        introduction="A Spanish paper of 2021 on stride length finds rests by the stability of windows, carries "
        "gravity between them and integrates twice. Here its method runs as printed, with our choices, and beside a "
        "Kalman filter with zero-velocity updates." + lacking,
        trials=(str(seeds), "seeds of the noise"),
        command="python -m benchmarks stride_paper",
        bands="Bounds of our methods, and the experiments that show why drift harms the printed one.",
        claims="The paper's values and statements, and ours",
        figures="True positions black, as printed red or orange, ours green, the Kalman filter light blue.",
        source="paper",
    )
