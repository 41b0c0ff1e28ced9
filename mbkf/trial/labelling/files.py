"""A labelled capture on disk, and beside it the summary of its labelling."""

from __future__ import annotations

import json
from pathlib import Path

from mbkf.io.atomic import replacing
from mbkf.io.capture import write_capture
from mbkf.io.records import Capture
from mbkf.trial.labelling.result import Labelling, LabelSummary, label_summary, labelled_capture
from mbkf.trial.labelling.score import LabelScore


def write_labels(
    raw: Capture, found: Labelling, path: str | Path, compared: LabelScore | None = None
) -> LabelSummary:
    """Writes the labelled capture in the format of its suffix, and its summary as FILE.json; returns the summary.

    Args:
        raw: The capture as recorded.
        found: Its labels.
        path: The labelled file.
        compared: The labels against a truth.

    Raises:
        FileFormatError: The file cannot be written.
    """
    path = Path(path)
    told = path.with_suffix(".json")
    labelled, summary = labelled_capture(raw, found), label_summary(found, compared)
    told.unlink(missing_ok=True)  # so that none ever stands beside another capture than its own
    write_capture(labelled, path)
    with replacing(told) as partial:
        partial.write_text(json.dumps(summary, indent=2) + "\n", encoding="utf-8")
    return summary
