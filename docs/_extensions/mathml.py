"""Equations as MathML, made while the pages are built: nothing is loaded from the network to read them."""

from __future__ import annotations

from typing import Any

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx

SCRIPT_N = "\N{MATHEMATICAL SCRIPT CAPITAL N}"
"""The normal distribution's letter; browsers do not take it from MathML's attribute for script."""


def mathml(latex: str, display: str) -> str:
    """An equation in LaTeX as an element of MathML."""
    return convert(latex.replace(r"\mathcal N", SCRIPT_N), display=display)


def inline(writer: Any, node: nodes.math) -> None:
    """An equation within a line."""
    writer.body.append(mathml(node.astext(), "inline"))
    raise nodes.SkipNode


def block(writer: Any, node: nodes.math_block) -> None:
    """An equation of its own, with its number where it has one."""
    label = node.get("number")
    number = f'<span class="eqno">({label})</span>' if label else ""
    anchor = f' id="{node["ids"][0]}"' if node.get("ids") else ""
    writer.body.append(f'<div class="math"{anchor}>{number}{mathml(node.astext(), "block")}</div>\n')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, Any]:
    """Makes this the way equations are written in pages."""
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
