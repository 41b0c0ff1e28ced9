"""Files of a labelled capture and of the summary beside it."""

from __future__ import annotations

import json
from pathlib import Path

from mbkf.io.atomic import write_text
from mbkf.io.atomic_folder import replacing_beside
from mbkf.io.capture import write_capture
from mbkf.io.records import Capture
from mbkf.trial.labelling.result import Labelling, LabelSummary, label_summary, labelled_capture
from mbkf.trial.labelling.score import LabelScore


def write_labels(
    raw: Capture, found: Labelling, path: str | Path, compared: LabelScore | None = None
) -> LabelSummary:
    """Writes the labelled capture in the format of its suffix, and its summary as FILE.json; returns the summary.

    Both take their places together, or earlier ones stay.

    Args:
        raw: The capture as recorded.
        found: Its labels.
        path: The labelled file.
        compared: Comparison of the labels with a truth.

    Raises:
        FileFormatError: The file cannot be written.
    """
    path = Path(path)
    labelled, summary = labelled_capture(raw, found), label_summary(found, compared)
    with replacing_beside(path) as partial:
        write_capture(labelled, partial / path.name)
        write_text(partial / path.with_suffix(".json").name, json.dumps(summary, indent=2) + "\n")
    return summary
