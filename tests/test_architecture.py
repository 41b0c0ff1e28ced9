"""The shape of the source tree: who may import whom, how long things get, what is documented and tested."""

import ast
import importlib
import re
from itertools import chain
from pathlib import Path

import pytest

from benchmarks.house.circles import circle_in, circles, imported_modules, imports_of, module_name
from benchmarks.house.documentation import classes_of, documentation, faults

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "mbkf"
TESTS = ROOT / "tests"

LAYERS = (
    {"errors", "conventions", "version"},
    {"numerics"},
    {"kernel"},
    {"io"},
    {"model"},
    {"sensors"},
    {"scaling", "labelling", "filters", "imu", "synthesis"},
    {"marker_sets"},
    {"trial"},
    {"study"},
    {"stream"},
    {"viz"},
    {"app"},
    {"cli"},
)
"""Rooms from left to right: a file imports from its own room and from rooms further left, nothing else."""

RANK = {room: rank for rank, rooms in enumerate(LAYERS) for room in rooms}
SURFACE = {"__init__", "__main__"}
"""Files at the top that belong to no room: the public surface and the start of ``python -m mbkf``."""

MAX_FILE_LINES = 400
MAX_FUNCTION_LINES = 80
LONG_FILES: dict[str, str] = {}
"""Files allowed to be longer, each with its reason: {"mbkf/io/c3d.py": "why it holds one idea"}."""
LONG_FUNCTIONS: dict[str, str] = {}
"""Functions allowed to be longer, each with its reason: {"mbkf/io/c3d.py:read": "why"}."""
UNTESTED: dict[str, str] = {}
"""Modules without a test of their own, each with its reason: {"mbkf/io/x.py": "where it is tested"}."""

SOURCES = sorted(PACKAGE.rglob("*.py"))
BENCHMARKS = sorted((ROOT / "benchmarks").rglob("*.py"))
LINTED = sorted(chain(SOURCES, BENCHMARKS, TESTS.rglob("*.py")))
CLASSES = classes_of(ast.parse(path.read_text(encoding="utf-8")) for path in chain(SOURCES, BENCHMARKS))
"""Among them overridden methods are looked for, whose description serves the override as well."""


def relative(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def tree_of(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"), str(path))


def room_of(path: Path) -> str:
    """First folder below the package, or the file's own name at the top."""
    return path.relative_to(PACKAGE).with_suffix("").parts[0]


def forbidden(room: str, imports: set[str]) -> list[str]:
    """Those imports that look to the right of a room, at a neighbour, or at the public surface."""
    bad = []
    for name in sorted(imports):
        package, _, rest = name.partition(".")
        if package != "mbkf":
            continue
        other = rest.split(".")[0]
        if other != room and (other not in RANK or RANK[other] > RANK[room] or is_neighbour(room, other)):
            bad.append(name)
    return bad


def is_neighbour(room: str, other: str) -> bool:
    return 0 < RANK[room] == RANK[other]


@pytest.mark.parametrize("path", SOURCES, ids=relative)
def test_file_imports_only_from_rooms_to_its_left(path):
    room = room_of(path)
    if room in SURFACE:
        pytest.skip("the public surface may show every room")
    assert room in RANK, f"{room} is not a room; add it to LAYERS if the design says so"
    assert forbidden(room, imports_of(path)) == []


@pytest.mark.parametrize(
    ("room", "source", "bad"),
    [
        ("io", "from mbkf.errors import MbkfError", []),
        ("io", "def f():\n    from mbkf.model import body", ["mbkf.model.body"]),
        ("io", "from ..model import body", ["mbkf.model.body"]),
        ("io", "from . import records", []),
        ("io", "from .. import cli", ["mbkf.cli"]),
        ("filters", "import mbkf.scaling.offline", ["mbkf.scaling.offline"]),
        ("filters", "import mbkf", ["mbkf"]),
        ("filters", "from mbkf import scale", ["mbkf.scale"]),
        ("conventions", "from mbkf.errors import ShapeError", []),
        ("cli", "import numpy\nfrom mbkf.viz import scene", []),
    ],
)
def test_the_import_rule_sees_what_it_should(room, source, bad):
    assert forbidden(room, imported_modules(ast.parse(source), f"mbkf.{room}")) == bad


def test_no_files_import_each_other_in_a_circle():
    assert circles() == []


def test_a_circle_is_found():
    a, b, c = (ROOT / name for name in ("a.py", "b.py", "c.py"))
    assert circle_in({a: {b}, b: {c}, c: set()}) == []
    assert circle_in({a: {b}, b: {c}, c: {b}}) == [b, c, b]


@pytest.mark.parametrize("path", SOURCES, ids=relative)
def test_file_begins_with_a_sentence(path):
    docstring = ast.get_docstring(tree_of(path)) or ""
    first = docstring.partition("\n\n")[0]
    assert len(first.split()) >= 3, "a module docstring of at least a sentence says what the file is for"
    assert first.endswith((".", "?", ":")), "the first paragraph is a sentence"


@pytest.mark.parametrize("path", LINTED, ids=relative)
def test_files_and_functions_stay_short(path):
    text = path.read_text(encoding="utf-8")
    if relative(path) not in LONG_FILES:
        assert len(text.splitlines()) <= MAX_FILE_LINES, "split by idea, or list it with its reason"
    long = [
        node.name
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        and node.end_lineno - node.lineno + 1 > MAX_FUNCTION_LINES
        and f"{relative(path)}:{node.name}" not in LONG_FUNCTIONS
    ]
    assert long == []


def test_exceptions_name_things_that_exist():
    for name in chain(LONG_FILES, UNTESTED, (key.partition(":")[0] for key in LONG_FUNCTIONS)):
        assert (ROOT / name).is_file(), name


@pytest.mark.parametrize("path", [p for p in SOURCES if p.name == "__init__.py"], ids=relative)
def test_public_names_exist_and_are_documented(path):
    package = importlib.import_module(module_name(path))
    public = list(getattr(package, "__all__", ()))
    assert public == sorted(public), "__all__ is sorted"
    for name in public:
        thing = getattr(package, name)  # an AttributeError here is a name that does not exist
        if callable(thing) and hasattr(thing, "__module__"):
            assert (thing.__doc__ or "").strip(), f"{name} has no docstring"


@pytest.mark.parametrize("path", [*SOURCES, *BENCHMARKS], ids=relative)
def test_public_definitions_are_documented(path):
    assert [str(fault) for fault in faults(tree_of(path).body, CLASSES)] == []


@pytest.mark.parametrize(
    ("source", "found"),
    [
        ("def f(): pass", ["f: no docstring"]),
        ("def _f(): pass", []),
        ("def f(a, b):\n 'x'", []),
        ("def f(a, *b, c):\n 'x'", ["f: no Args section"]),
        ("def f(a, b, c):\n 'x\\nArgs:'", []),
        ("class A:\n 'x'\n def f(self, a, b): 'x'\n def g(self, a, b, c): 'x'", ["A.g: no Args section"]),
        ("class A:\n 'a: 1, b: 2'\n def __init__(self, a, b, c): pass", ["A.__init__: c not described"]),
        ("class A:\n 'x'\n @property\n def f(self): pass", ["A.f: no docstring"]),
        ("class A: pass", ["A: no docstring"]),
        ("class B(Base[int]):\n 'x'\n def f(self, a, b, c): 'x'", []),
        ("class B(Base[int]):\n 'x'\n def f(self, a, b, c): pass", ["B.f: no docstring"]),
        ("class C(Derived):\n 'x'\n def f(self, a, b, c): 'x'", []),
        ("class C(Derived):\n 'x'\n def g(self, a, b, c): 'x'", ["C.g: no Args section"]),
    ],
)
def test_the_rule_of_documentation_sees_what_it_should(source, found):
    known = "class Base:\n def f(self, a, b, c):\n  'x\\nArgs:'\n def g(self, a, b, c): 'x'\nclass Derived(Base): pass"
    classes = classes_of([ast.parse(known), ast.parse(source)])
    assert [str(fault) for fault in faults(ast.parse(source).body, classes)] == found


def test_the_counts_of_documentation_are_a_row():
    assert documentation().row.endswith(": 0; 0")


def test_the_package_has_a_public_surface():
    assert importlib.import_module("mbkf").__all__


@pytest.mark.parametrize("path", [p for p in SOURCES if room_of(p) != "cli"], ids=relative)
def test_only_the_command_line_prints(path):
    prints = [
        node.lineno
        for node in ast.walk(tree_of(path))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print"
    ]
    assert prints == []


def test_no_drawers():
    """A file called utils holds no idea of its own."""
    drawers = re.compile(r"_*(utils?|common|misc|helpers?|tools?)")
    named = [path.parent.name if path.name == "__init__.py" else path.stem for path in SOURCES]
    assert [name for name in named if drawers.fullmatch(name)] == []


@pytest.mark.parametrize(
    "path", [p for p in SOURCES if p.parent != PACKAGE and p.name != "__init__.py"], ids=relative
)
def test_module_has_its_test_file(path):
    """The test file of the same name, or one in the mirrored folder that imports the module itself."""
    if relative(path) in UNTESTED:
        pytest.skip(UNTESTED[relative(path)])
    folder = TESTS / path.relative_to(PACKAGE).parent
    if (folder / f"test_{path.stem}.py").is_file():
        return
    name = module_name(path)
    for test in folder.glob("test_*.py"):
        if any(found == name or found.startswith(f"{name}.") for found in imports_of(test)):
            return
    pytest.fail(f"write {relative(folder)}/test_{path.stem}.py, or name the module and a reason in UNTESTED")


def test_every_test_is_run():
    """A test without its prefix never runs: functions with assertions are tests or are called by one."""
    for path in sorted(TESTS.rglob("test_*.py")):
        tree = tree_of(path)
        names = [node.id for node in ast.walk(tree) if isinstance(node, ast.Name)]
        names += [node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)]
        for node in tree.body:
            if isinstance(node, ast.FunctionDef) and not node.name.startswith("test_"):
                used = node.name in names or node.decorator_list
                assert used, f"{relative(path)}: {node.name} is neither a test nor used"
