"""Source files as trees: each parsed once, and its statements without their expressions."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path


@cache
def parsed(source: str) -> ast.Module:
    """The tree of a source text."""
    return ast.parse(source)


def tree_of(path: Path) -> ast.Module:
    """The tree of a source file."""
    return parsed(path.read_text(encoding="utf-8"))


def statements(tree: ast.AST) -> Iterator[ast.AST]:
    """All statements below a node, however deep; expressions, most of a tree's nodes, are passed over."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.stmt | ast.excepthandler | ast.match_case):
            yield node
            yield from statements(node)
