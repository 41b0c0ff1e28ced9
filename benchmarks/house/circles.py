"""Imports between the files of a source tree, and circles in them."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Mapping
from pathlib import Path

from benchmarks.house.sources import statements, tree_of

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("mbkf", "benchmarks")


def circles(root: Path = ROOT, folders: Iterable[str] = FOLDERS) -> list[str]:
    """One circle of files that import each other, the first of them named again at the end; empty where none is.

    Imports for types only and within functions count.
    """
    modules = {
        module_name(path, root): path for name in folders for path in sorted((root / name).rglob("*.py"))
    }
    found = circle_in({path: imported_files(path, root, modules) for path in modules.values()})
    return [path.relative_to(root).as_posix() for path in found]


def module_name(path: Path, root: Path = ROOT) -> str:
    """Dotted name under which a file of the tree is imported."""
    parts = path.relative_to(root).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imported_modules(tree: ast.AST, package: str) -> set[str]:
    """Dotted names a file imports, wherever the statement stands.

    ``from a import b`` counts as ``a.b``, which may be a module or a name of ``a``; relative imports are
    resolved against ``package``.
    """
    found = set()
    for node in statements(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                above = package.split(".")[: len(package.split(".")) - node.level + 1]
                base = ".".join([*above, base] if base else above)
            found |= {f"{base}.{alias.name}" for alias in node.names}
    return found


def imports_of(path: Path, root: Path = ROOT) -> set[str]:
    """Dotted names that a file of the tree imports."""
    name = module_name(path, root)
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    return imported_modules(tree_of(path), package)


def imported_files(path: Path, root: Path, modules: Mapping[str, Path]) -> set[Path]:
    """Files that a file imports, itself left out.

    Args:
        path: The file.
        root: Folder of the tree.
        modules: Files of the tree by their dotted names.
    """
    found = {modules.get(name) or modules.get(name.rpartition(".")[0]) for name in imports_of(path, root)}
    return {other for other in found if other is not None and other != path}


def circle_in(edges: Mapping[Path, set[Path]]) -> list[Path]:
    """One circle in a graph, its first node again at the end; empty where there is none."""
    done: set[Path] = set()

    def visit(path: Path, way: list[Path]) -> list[Path]:
        if path in way:
            return [*way[way.index(path) :], path]
        if path in done:
            return []
        for other in sorted(edges[path]):
            if found := visit(other, [*way, path]):
                return found
        done.add(path)
        return []

    return next((found for path in edges if (found := visit(path, []))), [])
