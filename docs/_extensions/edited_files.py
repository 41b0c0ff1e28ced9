"""The directive ``entries``: a table of the entries of a file that people edit, from their declaration."""

from __future__ import annotations

from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from mbkf.io import body_covariance, inertia, laboratory, norms, preset, session, subject, trial_video, visit
from mbkf.io.fields import Record
from mbkf.io.imu import mount
from mbkf.study.batch import lists

RECORDS: dict[str, Record] = {
    "session": session.SESSION,
    "session-trial": session.TRIAL,
    "session-event": session.EVENT,
    "session-video": trial_video.VIDEO,
    "session-visit": visit.VISIT,
    "laboratory": laboratory.LABORATORY,
    "list-csv": lists.CSV_LIST,
    "list-person": lists.LISTED_PERSON,
    "list-trial": lists.LISTED_TRIAL,
    "subject": subject.SUBJECT,
    "subject-marker": subject.MARKER,
    "subject-inertia": inertia.INERTIA,
    "subject-covariance": body_covariance.COVARIANCE,
    "preset": preset.PRESET,
    "norms": norms.NORMS,
    "norms-curve": norms.CURVE,
    "norms-person": norms.PERSON,
    "norms-gdi": norms.GDI,
    "norms-measure": norms.MEASURE,
    "mount": mount.MOUNT,
}
"""Records by their names in pages."""


class Entries(SphinxDirective):
    """Entries with value and meaning."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """The table."""
        return self.parse_text_to_nodes("\n".join(entry_rows(self.arguments[0])))


def entry_rows(name: str) -> list[str]:
    """Lines of the table of a record."""
    return ["| entry | value | meaning |", "|---|---|---|", *RECORDS[name].rows()]


def setup(app: Sphinx) -> dict[str, Any]:
    """Adds the directive."""
    app.add_directive("entries", Entries)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
