"""How well the public definitions of a source tree are documented: docstrings, and arguments where there are many.

A class is documented by a docstring, a function of three or more arguments also by an Args section, a constructor of
so many by every argument's name with a colon in its own docstring or the class's. An override needs no Args where
the method that it overrides has them.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from benchmarks.house.sources import tree_of

ROOT = Path(__file__).resolve().parents[2]
MANY_ARGUMENTS = 3

Function = ast.FunctionDef | ast.AsyncFunctionDef
Classes = Mapping[str, ast.ClassDef]
"""Classes by their names; a base is looked up by its last name."""


class Fault(NamedTuple):
    """A public definition that is not documented.

    Attributes:
        name: The definition, with its class's name before it.
        what: What it lacks.
        docstring: Whether it lacks a docstring; otherwise the description of its arguments.
    """

    name: str
    what: str
    docstring: bool

    def __str__(self) -> str:
        return f"{self.name}: {self.what}"


@dataclass(frozen=True)
class Documentation:
    """Faults of a source tree.

    Attributes:
        undocumented: Public definitions without a docstring, each with its file.
        without_arguments: Public functions of three or more arguments without their description, each with its file.
    """

    undocumented: tuple[str, ...]
    without_arguments: tuple[str, ...]


def documentation(root: Path = ROOT, folders: Iterable[str] = ("mbkf", "benchmarks")) -> Documentation:
    """Counts what the folders of a source tree leave undocumented."""
    paths = [path for folder in folders for path in sorted((root / folder).rglob("*.py"))]
    trees = {path: tree_of(path) for path in paths}
    classes = classes_of(trees.values())
    found = [
        (f"{path.relative_to(root).as_posix()}: {fault}", fault.docstring)
        for path, tree in trees.items()
        for fault in faults(tree.body, classes)
    ]
    return Documentation(
        tuple(text for text, docstring in found if docstring),
        tuple(text for text, docstring in found if not docstring),
    )


def classes_of(trees: Iterable[ast.Module]) -> dict[str, ast.ClassDef]:
    """Classes at the top of modules, by name."""
    return {node.name: node for tree in trees for node in tree.body if isinstance(node, ast.ClassDef)}


def faults(body: list[ast.stmt], classes: Classes, owner: ast.ClassDef | None = None) -> list[Fault]:
    """Public definitions without a docstring, or with many arguments and without their description.

    Args:
        body: Statements of a module or of a class.
        classes: Classes among which overridden methods are looked for.
        owner: The class the statements belong to; None for a module's.
    """
    found: list[Fault] = []
    prefix = "" if owner is None else f"{owner.name}."
    for node in body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            if not ast.get_docstring(node):
                found.append(Fault(prefix + node.name, "no docstring", True))
            found += [fault._replace(name=prefix + fault.name) for fault in faults(node.body, classes, node)]
        elif isinstance(node, Function) and (what := _fault_of_function(node, owner, classes)):
            found.append(Fault(prefix + node.name, what, what == "no docstring"))
    return found


def _fault_of_function(node: Function, owner: ast.ClassDef | None, classes: Classes) -> str:
    doc = ast.get_docstring(node) or ""
    names = _arguments_of(node)
    if node.name == "__init__" and owner is not None:
        described = (ast.get_docstring(owner) or "") + doc
        missing = [name for name in names if f"{name}:" not in described]
        return f"{', '.join(missing)} not described" if len(names) >= MANY_ARGUMENTS and missing else ""
    decorators = {ast.unparse(decorator).rpartition(".")[2] for decorator in node.decorator_list}
    if node.name.startswith("_") or decorators & {"overload", "setter"}:
        return ""
    if not doc:
        return "no docstring"
    few = len(names) < MANY_ARGUMENTS or decorators & {"property", "cached_property"}
    if few or "Args:" in doc or (owner is not None and _described_above(node.name, owner, classes)):
        return ""
    return "no Args section"


def _described_above(method: str, owner: ast.ClassDef, classes: Classes) -> bool:
    """Whether a class that the owner derives from describes the method's arguments."""
    return any(
        "Args:" in (ast.get_docstring(node) or "")
        for base in _bases(owner, classes)
        for node in base.body
        if isinstance(node, Function) and node.name == method
    )


def _bases(owner: ast.ClassDef, classes: Classes) -> Iterator[ast.ClassDef]:
    """The classes that a class derives from, as far as they stand in the tree."""
    for expression in owner.bases:
        named = expression.value if isinstance(expression, ast.Subscript) else expression
        base = classes.get(ast.unparse(named).rpartition(".")[2])
        if base is not None and base is not owner:
            yield base
            yield from _bases(base, classes)


def _arguments_of(node: Function) -> list[str]:
    """Names of all arguments but self and cls."""
    own = node.args
    every = [*own.posonlyargs, *own.args, own.vararg, *own.kwonlyargs, own.kwarg]
    return [one.arg for one in every if one is not None and one.arg not in ("self", "cls")]
