"""The directives ``step-files`` and ``step-files-left-out``: tables of source files with their lines, counted anew."""

from __future__ import annotations

from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from benchmarks.house.step_files import LEFT_OUT, READ, StepFile, parsed


class StepFiles(SphinxDirective):
    """Files with what they do in a step, in reading order, and their lines."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        """The table."""
        files = parsed(self.content)
        for one in files:
            self.env.note_dependency(f"../mbkf/{one.path}")
        return self.parse_text_to_nodes("\n".join(self.rows(files)))

    def rows(self, files: list[StepFile]) -> list[str]:
        """Lines of the table."""
        total = sum(one.lines for one in files)
        return [
            "| | file in `mbkf/` | in a step | lines |",
            "|---|---|---|---:|",
            *(f"| {k} | `{one.path}` | {one.sentence} | {one.lines} |" for k, one in enumerate(files, 1)),
            f"| | **{len(files)} files** | | **{total:,}** |",
        ]


class StepFilesLeftOut(StepFiles):
    """Files that a step executes and that need not be opened, with the reason."""

    def rows(self, files: list[StepFile]) -> list[str]:
        """Lines of the table."""
        return [
            "| file in `mbkf/` | why it is left out |",
            "|---|---|",
            *(f"| `{one.path}` | {one.sentence} |" for one in files),
        ]


def setup(app: Sphinx) -> dict[str, Any]:
    """Adds the directives."""
    app.add_directive(READ, StepFiles)
    app.add_directive(LEFT_OUT, StepFilesLeftOut)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
