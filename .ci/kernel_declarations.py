"""Reads the declarations of the compiled kernel's functions, records and handles.

The grammar is that of ``mbkf/kernel/declaration.py``. Declarations are parsed and not imported, since the environment
in which a wheel is built holds neither SciPy nor Pinocchio.
"""

from __future__ import annotations

import ast
import importlib.util
import re
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType

ARRAYS = {
    "Array": ("double", "FLOAT64"),
    "Int32Array": ("int", "INT32"),
    "BoolArray": ("char", "BOOL"),
}
"""C type of a number, and kind of array in ``arguments.h``, by the annotation."""

SCALARS = {"float": "double", "int": "int", "bool": "int"}
ORDERS = {"": "C_ORDER", "fortran": "FORTRAN_ORDER", "symmetric": "ANY_ORDER"}
NAME = re.compile(r"[A-Za-z_]\w*")


@dataclass(frozen=True)
class Value:
    """An argument or a result.

    Attributes:
        name: Its name; empty for the C function's own result.
        type: Array, Int32Array, BoolArray, float, int, bool, or the name of a record or handle.
        role: In, Out or Made of an array; empty for other values.
        sizes: Expressions of an array's dimensions; the first may begin with ``*``.
        order: Empty, ``fortran`` or ``symmetric``.
        bounds: Expressions of the least value and of the end, for indices.
        optional: May be None.
    """

    name: str
    type: str
    role: str = ""
    sizes: tuple[str, ...] = ()
    order: str = ""
    bounds: tuple[str, str] | None = None
    optional: bool = False

    @property
    def is_array(self) -> bool:
        """True for arrays."""
        return self.type in ARRAYS


@dataclass(frozen=True)
class Function:
    """A declared function.

    Attributes:
        name: Its name.
        arguments: In order.
        sizes: Names of sizes that arrays set, in order.
        returned: Type that the C function itself returns; ``void`` for none.
        made: Results that the C function fills.
        requires: Conditions on sizes and integers.
        unlocked: Runs without the interpreter's lock.
    """

    name: str
    arguments: tuple[Value, ...]
    sizes: tuple[str, ...]
    returned: str
    made: tuple[Value, ...]
    requires: tuple[str, ...]
    unlocked: bool


@dataclass
class Declarations:
    """All of them; records and handles hold their fields, a record's with the fields' types."""

    records: dict[str, dict[str, str]] = field(default_factory=dict)
    handles: dict[str, tuple[str, ...]] = field(default_factory=dict)
    functions: dict[str, Function] = field(default_factory=dict)
    fingerprint: str = ""


def declarations(folder: Path) -> Declarations:
    """Reads the declarations in the kernel's folder."""
    grammar, found = _grammar(folder), Declarations()
    for name in grammar.FILES:
        for node in ast.parse((folder / name).read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ClassDef):
                _read_class(node, found)
    found.fingerprint = grammar.fingerprint(folder)
    return found


def _grammar(folder: Path) -> ModuleType:
    """The module ``declaration.py``, which imports nothing else of mbkf."""
    spec = importlib.util.spec_from_file_location("mbkf_kernel_declaration", folder / "declaration.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _read_class(node: ast.ClassDef, found: Declarations) -> None:
    bases = {ast.unparse(base) for base in node.bases}
    fields = {
        ast.unparse(line.target): ast.unparse(line.annotation)
        for line in node.body
        if isinstance(line, ast.AnnAssign)
    }
    if "NamedTuple" in bases:
        found.records[node.name] = fields
    elif "Handle" in bases:
        found.handles[node.name] = tuple(fields)
    elif "Protocol" in bases:
        functions = (_function(line, found) for line in node.body if isinstance(line, ast.FunctionDef))
        found.functions.update({one.name: one for one in functions})


def _function(node: ast.FunctionDef, found: Declarations) -> Function:
    arguments = tuple(_value(one.annotation, one.arg) for one in node.args.posonlyargs[1:])
    results = node.returns
    several = isinstance(results, ast.Subscript) and ast.unparse(results.value) == "tuple"
    parts = results.slice.elts if several else [results]  # type: ignore[union-attr]
    values = [_value(part) for part in parts]
    own = [one.type for one in values if one.role != "Made"]
    known = {*ARRAYS, *SCALARS, *found.records, *found.handles, "None"}
    for one in (*arguments, *values):
        if one.type not in known:
            raise ValueError(f"{node.name}: {one.name or 'result'} has the unknown type {one.type}")
    if len(own) > 1:
        raise ValueError(f"{node.name}: a C function returns one value; make the others with Made")
    set_by_others = {one.name for one in arguments if one.type == "int"}
    set_by_others.update(size for one in arguments for size in found.handles.get(one.type, ()))
    named = (size.lstrip("*") for one in arguments for size in one.sizes)
    decorators = [
        (ast.unparse(one.func), one.args) for one in node.decorator_list if isinstance(one, ast.Call)
    ]
    return Function(
        node.name,
        arguments,
        tuple(dict.fromkeys(size for size in named if NAME.fullmatch(size) and size not in set_by_others)),
        "void" if not own or own[0] == "None" else own[0],
        tuple(one for one in values if one.role == "Made"),
        tuple(ast.literal_eval(one) for name, given in decorators if name == "requires" for one in given),
        any(ast.unparse(one) == "unlocked" for one in node.decorator_list),
    )


def _value(annotation: ast.expr | None, name: str = "") -> Value:
    """An argument or result from its annotation."""
    if isinstance(annotation, ast.BinOp):  # X | None
        return Value(**{**vars(_value(annotation.left, name)), "optional": True})
    if not isinstance(annotation, ast.Subscript):
        return Value(name, ast.unparse(annotation) if annotation is not None else "None")
    role = ast.unparse(annotation.value)
    kind, text = annotation.slice.elts  # type: ignore[attr-defined]
    shape = ast.literal_eval(text)
    if role == "Made":
        name, _, shape = shape.partition(":")
    shape, _, bounds = shape.partition(" in ")
    words = shape.split()
    order = words.pop() if words and words[-1] in ORDERS else ""
    low, _, end = bounds.partition(":")
    return Value(name, ast.unparse(kind), role, tuple(words), order, (low, end) if end else None)
