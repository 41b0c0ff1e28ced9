"""The directive ``gallery``: examples of ``docs/gallery`` with picture, printed lines, code and capture."""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

DOCS = Path(__file__).resolve().parents[1]


class Gallery(SphinxDirective):
    """Small pictures that lead to the examples named in the content, then a section per example."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        """The small pictures and the sections."""
        overview = nodes.container(classes=["gallery"])
        found: list[nodes.Node] = [overview]
        for name in self.content:
            self.env.note_dependency(f"gallery/{name}.py")
            title, text = described(name)
            own = nodes.section("", nodes.title("", title), ids=[nodes.make_id(title)], names=[title.lower()])
            self.state.document.note_implicit_target(own)
            own += self.parse_text_to_nodes(text)
            link = nodes.reference("", "", refuri=f"#{own['ids'][0]}", internal=True)
            link += [nodes.image(uri=f"gallery/{name}.png", alt=""), nodes.inline("", title)]
            overview += nodes.paragraph("", "", link)
            found.append(own)
        return found


def described(name: str) -> tuple[str, str]:
    """Title of an example, and its section in Markdown: purpose, picture, printed lines, capture and code."""
    docstring = ast.get_docstring(ast.parse((DOCS / "gallery" / f"{name}.py").read_text(encoding="utf-8")))
    title, text, last = str(docstring).split("\n\n")
    capture = last.removeprefix("Capture: ")
    return (
        title.rstrip("."),
        f"""{text}

![{title}](gallery/{name}.png)

```{{literalinclude}} gallery/{name}.txt
:language: text
```

Capture `{capture}`: {source(capture)}

```{{literalinclude}} gallery/{name}.py
:start-at: import os
```
""",
    )


def source(capture: str) -> str:
    """Repository, licence and citation of a capture, from its row in the page on captures.

    Raises:
        ValueError: The page has no such row.
    """
    page = (DOCS / "captures.md").read_text(encoding="utf-8")
    row = re.search(rf"^\| \*\*{capture}\*\*: (.+) \| (.+) \| (.+) \|$", page, re.MULTILINE)
    if row is None:
        raise ValueError(f"docs/captures.md does not state where '{capture}' is had")
    return f"{row[1]}; licence: {row[2]}; {row[3]}."


def setup(app: Sphinx) -> dict[str, Any]:
    """Adds the directive."""
    app.add_directive("gallery", Gallery)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
