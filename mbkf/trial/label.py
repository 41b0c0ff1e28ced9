"""From unlabelled points and a subject to named trajectories."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mbkf.conventions import StageCallback
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.labelling.assignment import HIDDEN
from mbkf.labelling.running import RunningSettings
from mbkf.numerics.threads import single_threaded
from mbkf.trial.labelling.body import label_body
from mbkf.trial.labelling.both_ways import most_likely_run
from mbkf.trial.labelling.known_names import known_names, no_names, with_claims
from mbkf.trial.labelling.relabelling import relabel_offline, trajectories
from mbkf.trial.labelling.result import Labelling
from mbkf.trial.labelling.scaled_doubts import scaled_doubts
from mbkf.trial.labelling.starts import Start, find_starts
from mbkf.trial.preparation.in_view import far_points


def label(
    capture: Capture,
    subject: Subject,
    *,
    start: Start | None = None,
    ignore_names: bool = False,
    progress: StageCallback | None = None,
) -> Labelling:
    """Names the points of a capture.

    The columns of the capture may be tracks or may be shuffled in every frame. The capture is labelled from its surest
    frame forwards and backwards; then every track is judged again by a smoothed body, with the subject's marker
    geometry corrected on the result (thesis 4.1.1).

    Args:
        capture: Points, wholly, partly or not named.
        subject: The scaled person. Markers that scaling never saw are not looked for.
        start: Frame and pose to start from; by default the start is searched for.
        ignore_names: True to ignore the capture's names; by default a name is relied on where it stays on its point
            from frame to frame and the body does not contradict it.
        progress: Called with the stage, items done and items in all.

    Raises:
        NotObservable: In no frame do the points fit the subject's markers.
    """
    report = progress or (lambda *_: None)
    points = capture.markers
    with single_threaded():
        subject = subject.in_neutral_posture()
        body = label_body(subject.markers, subject, RunningSettings())
        names = no_names(points) if ignore_names else known_names(points, body.markers, body.sensor)
        known = names.trusted if names.names else None
        starts = find_starts(body, points, start, known, report)
        run = most_likely_run(body, points, starts, known, lambda n, all_: report("Labelling", n, all_))
        found = relabel_offline(
            body, points, run.label_of_point, run.q, lambda n, all_: report("Relabelling", n, all_), known
        )
        found = replace(found, label_of_point=with_claims(found.label_of_point, names))
        present = ~np.isnan(points.positions_m).any(axis=2)
        markers = trajectories(points, found.label_of_point, body.names)
        unnamed = np.where((found.label_of_point == HIDDEN)[..., None], points.positions_m, np.nan)
        return Labelling(
            markers=markers,
            label_of_point=found.label_of_point,
            ghosts=np.asarray((present & (found.label_of_point == HIDDEN)).sum(axis=1)),
            starts=run.starts,
            repaired=run.repaired,
            step_seconds=run.step_seconds,
            relabelled=found.changed,
            doubts=scaled_doubts(body, points, found, names),
            others=far_points(unnamed, markers.positions_m),
        )
