"""The result of labelling: labels, the labelled capture, and the numbers of its summary."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NotRequired, TypedDict

import numpy as np

from mbkf.conventions import Array
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.labelling.assignment import Indices
from mbkf.trial.labelling.doubts import Doubts
from mbkf.trial.labelling.score import LabelScore
from mbkf.trial.preparation.in_view import FAR_M, LEAST_MARKERS


@dataclass(frozen=True)
class Labelling:
    """Labels of a capture.

    Attributes:
        markers: (T, M, 3) trajectories under the subject's names, NaN where a marker is hidden.
        label_of_point: (T, C) marker of every point of the capture, ``HIDDEN`` for ghosts and empty columns.
        ghosts: (T,) number of points that are no marker's.
        starts: Frames whose labels were searched without those of the frame before.
        repaired: Number of markers whose labels were taken back from a wrong point.
        step_seconds: (T,) computing time of each frame's labels without the filter's; NaN where they were searched.
        relabelled: Number of samples whose label was removed or changed by the offline relabelling.
        doubts: Possible errors in the labels.
        others: Number of points in the usual frame that lie too far from the subject to be one of the subject's.
    """

    markers: MarkerTrajectories
    label_of_point: Indices
    ghosts: Array
    starts: tuple[int, ...]
    repaired: int
    step_seconds: Array
    relabelled: int = 0
    doubts: Doubts | None = None
    others: int = 0

    @property
    def others_remark(self) -> str:
        """A remark on a second person in view; "" without one."""
        if self.others < LEAST_MARKERS:
            return ""
        return (
            f"{self.others} points lie more than {FAR_M:g} m from the subject's markers in the usual frame: a second "
            "person is in view; make sure that the right one is named, or record one person alone"
        )

    @property
    def assigned_fraction(self) -> float:
        """Share of marker-frames that have a point, over the markers the capture shows at all."""
        present = self.markers.present
        worn = present.any(axis=0)
        return float(present[:, worn].mean()) if worn.any() else 0.0

    @property
    def first_labelled_frame(self) -> int:
        """The first frame with a label."""
        return int(np.flatnonzero(self.markers.present.any(axis=1))[0])


class LabelSummary(TypedDict):
    """Plain numbers about labels, for the summary beside the labelled file.

    Attributes:
        frames, markers: Numbers of frames and of markers in them.
        assigned_fraction: Share of marker samples that a point was assigned to.
        ghosts_dropped, ghosts_per_frame: Points without a marker, in all and by frame.
        swaps_repaired: Exchanged labels that were put right.
        samples_relabelled: Marker samples that offline relabelling changed.
        first_labelled_frame: First frame with labels.
        starts: Frames whose labels were searched.
        step_seconds_median: Computing time of a frame.
        others_in_view: Points that lie too far from the subject in the usual frame.
        doubts: Labels that may be wrong.
        correct_fraction, wrong_fraction, missed_fraction: Comparison with a truth, where there is one.
    """

    frames: int
    markers: int
    assigned_fraction: float
    ghosts_dropped: int
    ghosts_per_frame: list[int]
    swaps_repaired: int
    samples_relabelled: int
    first_labelled_frame: int
    starts: list[int]
    step_seconds_median: float | None
    others_in_view: int
    doubts: NotRequired[dict[str, object]]
    correct_fraction: NotRequired[float]
    wrong_fraction: NotRequired[float]
    missed_fraction: NotRequired[float]


def label_summary(found: Labelling, compared: LabelScore | None = None) -> LabelSummary:
    """The summary beside the labelled file."""
    known = found.step_seconds[~np.isnan(found.step_seconds)]
    summary: LabelSummary = {
        "frames": found.markers.frames,
        "markers": int(found.markers.present.any(axis=0).sum()),
        "assigned_fraction": found.assigned_fraction,
        "ghosts_dropped": int(found.ghosts.sum()),
        "ghosts_per_frame": [int(n) for n in found.ghosts],
        "swaps_repaired": found.repaired,
        "samples_relabelled": found.relabelled,
        "first_labelled_frame": found.first_labelled_frame,
        "starts": list(found.starts),
        "step_seconds_median": float(np.median(known)) if len(known) else None,
        "others_in_view": found.others,
    }
    if found.doubts is not None:
        summary["doubts"] = found.doubts.summary()
    if compared is not None:
        summary["correct_fraction"] = compared.correct_fraction
        summary["wrong_fraction"] = compared.wrong_fraction
        summary["missed_fraction"] = compared.missed_fraction
    return summary


def labelled_capture(raw: Capture, found: Labelling) -> Capture:
    """The capture with its labelled markers in place of its points."""
    shown = np.flatnonzero(found.markers.present.any(axis=0))
    notes = (*raw.notes, found.others_remark) if found.others_remark else raw.notes
    return replace(
        raw, markers=found.markers.select(tuple(found.markers.names[k] for k in shown)), notes=notes
    )
