"""Public records and signatures are typed: none of their annotations says Any."""

import ast
import inspect
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import mbkf

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "mbkf"
UNTYPED = {
    "mbkf/filters/filter.py": "memories, noises and decisions of unlike blocks and plants stand in one list",
}
ANY = re.compile(r"\bAny\b")


def annotations(body: list[ast.stmt], prefix: str = "") -> Iterator[tuple[str, str]]:
    """Name and annotation of every public field, argument and result; bases of classes, too."""
    for node in body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            yield from ((f"{prefix}{node.name}", ast.unparse(base)) for base in node.bases)
            yield from annotations(node.body, f"{prefix}{node.name}.")
        elif isinstance(node, ast.AnnAssign) and not ast.unparse(node.target).startswith("_"):
            yield prefix + ast.unparse(node.target), ast.unparse(node.annotation)
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and not is_private(node.name):
            yield from signature(node, prefix)


def is_private(name: str) -> bool:
    return name.startswith("_") and not name.startswith("__")


def signature(node: ast.FunctionDef | ast.AsyncFunctionDef, prefix: str) -> Iterator[tuple[str, str]]:
    own = node.args
    for one in [*own.posonlyargs, *own.args, own.vararg, *own.kwonlyargs, own.kwarg]:
        if one is not None and one.annotation is not None:
            yield f"{prefix}{node.name}({one.arg})", ast.unparse(one.annotation)
    if node.returns is not None:
        yield f"{prefix}{node.name}", ast.unparse(node.returns)


def untyped(source: str) -> list[str]:
    return [name for name, text in annotations(ast.parse(source).body) if ANY.search(text)]


def test_no_public_annotation_is_any():
    files = {path.relative_to(ROOT).as_posix(): path for path in sorted(PACKAGE.rglob("*.py"))}
    found = {
        name: untyped(path.read_text(encoding="utf-8")) for name, path in files.items() if name not in UNTYPED
    }
    assert {name: faults for name, faults in found.items() if faults} == {}


def test_no_annotation_of_the_public_surface_is_any():
    """Not even of a name whose file is among the exceptions."""
    things = {name: getattr(mbkf, name) for name in mbkf.__all__}
    found = {
        name: untyped(inspect.getsource(thing))
        for name, thing in things.items()
        if inspect.isclass(thing) or inspect.isfunction(thing)
    }
    assert {name: faults for name, faults in found.items() if faults} == {}


@pytest.mark.parametrize(
    ("source", "found"),
    [
        ("def f(a: Any): ...", ["f(a)"]),
        ("def f() -> dict[str, Any]: ...", ["f"]),
        ("def _f(a: Any): ...", []),
        ("class A(Base[Any]):\n b: Any\n _c: Any", ["A", "A.b"]),
        ("class A:\n def __init__(self, a: Any): ...", ["A.__init__(a)"]),
        ("def f(blocks: list[AnyBlock]): ...", []),
        ("TomlTable: TypeAlias = dict[str, Any]", []),
    ],
)
def test_the_rule_sees_what_it_should(source, found):
    assert untyped(source) == found
