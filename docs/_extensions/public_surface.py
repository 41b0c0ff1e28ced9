"""The directive ``public-surface``: every name of ``mbkf.__all__`` with its docstring, in alphabetical order."""

from __future__ import annotations

import inspect
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

import mbkf


class PublicSurface(SphinxDirective):
    """Writes one section per public name."""

    def run(self) -> list[nodes.Node]:
        """The sections."""
        found: list[nodes.Node] = []
        for name in sorted(mbkf.__all__, key=str.lower):
            if name.startswith("__"):
                continue
            found += self.parse_text_to_nodes(_section(name), allow_section_headings=True)
        return found


def _section(name: str) -> str:
    """A heading and the autodoc directive that fits the object."""
    value = getattr(mbkf, name)
    if inspect.isclass(value):
        directive, options = "autoclass", "   :members:\n"
    elif inspect.isroutine(value):
        directive, options = "autofunction", ""
    else:
        directive, options = "autodata", "   :no-value:\n"
    return f"{name}\n{'-' * len(name)}\n\n.. {directive}:: mbkf.{name}\n{options}"


def setup(app: Sphinx) -> dict[str, Any]:
    """Adds the directive."""
    app.add_directive("public-surface", PublicSurface)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
