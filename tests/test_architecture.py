"""The shape of the source tree: who may import whom, how long things get, what is documented and tested."""

import ast
import gc
import importlib
import re
from collections import Counter
from itertools import chain
from pathlib import Path

import pytest

from benchmarks.house.circles import circle_in, circles, imported_modules, imports_of, module_name
from benchmarks.house.documentation import classes_of, documentation, faults
from benchmarks.house.folders import MOST_FILES, largest_folder
from benchmarks.house.prose import MOST_HARD, hard_to_read, is_hard, texts_of
from benchmarks.house.sources import parsed, statements, tree_of

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
UNTESTED: dict[str, str] = {
    f"mbkf/kernel/{name}_functions.py": "declares functions of the kernel: tests/kernel/test_declaration.py"
    for name in ("body", "contact", "force", "inertial", "smoothing", "state", "text", "tracking")
}
"""Modules without a test of their own, each with its reason: {"mbkf/io/x.py": "where it is tested"}."""

SOURCES = sorted(PACKAGE.rglob("*.py"))
LINTED = sorted(chain(SOURCES, (ROOT / "benchmarks").rglob("*.py"), TESTS.rglob("*.py")))


def relative(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


@pytest.fixture(scope="module", autouse=True)
def parsed_once():
    """Trees of two thousand files hold no circles, and do not stay when these tests are over."""
    gc.disable()
    yield
    parsed.cache_clear()
    gc.enable()


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


def test_rooms_are_those_of_the_layers():
    """Another folder or file at the top is added to LAYERS if the design says so."""
    assert {room_of(path) for path in SOURCES} - SURFACE == set(RANK)


def test_files_import_only_from_rooms_to_their_left():
    rooms = {path: room_of(path) for path in SOURCES if room_of(path) in RANK}
    bad = {relative(path): forbidden(room, imports_of(path)) for path, room in rooms.items()}
    assert {path: imports for path, imports in bad.items() if imports} == {}


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


def test_files_begin_with_a_sentence():
    """A docstring of at least three words states the purpose of each file; ruff holds its form."""
    docstrings = {relative(path): ast.get_docstring(tree_of(path)) or "" for path in SOURCES}
    firsts = {path: text.partition("\n\n")[0] for path, text in docstrings.items()}
    assert [path for path, text in firsts.items() if len(text.split()) < 3 or text[-1] not in ".?:"] == []


def test_files_stay_short():
    """A file that is too long is split by idea, or listed in LONG_FILES with its reason."""
    lines = {relative(path): len(path.read_text(encoding="utf-8").splitlines()) for path in LINTED}
    assert {path: n for path, n in lines.items() if n > MAX_FILE_LINES and path not in LONG_FILES} == {}


def test_functions_stay_short():
    """A function that is too long is split, or listed in LONG_FUNCTIONS with its reason."""
    lines = {
        f"{relative(path)}:{node.name}": node.end_lineno - node.lineno + 1
        for path in LINTED
        for node in statements(tree_of(path))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    }
    assert {
        name: n for name, n in lines.items() if n > MAX_FUNCTION_LINES and name not in LONG_FUNCTIONS
    } == {}


def test_exceptions_name_things_that_exist():
    for name in chain(LONG_FILES, UNTESTED, (key.partition(":")[0] for key in LONG_FUNCTIONS)):
        assert (ROOT / name).is_file(), name


def test_public_names_exist_and_are_documented():
    for path in SOURCES:
        if path.name != "__init__.py":
            continue
        package = importlib.import_module(module_name(path))
        public = list(getattr(package, "__all__", ()))
        assert public == sorted(public), f"{relative(path)}: __all__ is not sorted"
        for name in public:
            thing = getattr(package, name)  # an AttributeError here is a name that does not exist
            if callable(thing) and hasattr(thing, "__module__"):
                assert (thing.__doc__ or "").strip(), f"{relative(path)}: {name} has no docstring"


def test_public_definitions_are_documented():
    found = documentation()
    assert [*found.undocumented, *found.without_arguments] == []


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


def test_prose_is_easy_to_read():
    """At most so many docstrings and messages open with a word or hold a phrase that costs a second reading."""
    texts = texts_of(SOURCES)
    hard = Counter(relative(one.path) for one in texts if is_hard(one.text))
    assert sum(hard.values()) <= MOST_HARD * len(texts), hard.most_common(30)


@pytest.mark.parametrize(
    ("source", "hard"),
    [
        ('"""Whether the foot moves."""', 1),
        ('"""True where the foot moves. Whether it stands is another matter."""', 0),
        ('x = 1\n"""None: the frame has no readings."""', 1),
        ('"""The whatever."""', 0),
        ('raise E(f"{a} is no unit of length at all")', 1),
        ('raise E("the unit of a is\\n no length")', 1),
        ('note("the sides that the user is told of are swapped")', 1),
        ('note("the unit is now the metre")', 0),
        ('f = {"told of": 1}', 0),
    ],
)
def test_the_rule_of_prose_sees_what_it_should(source, hard, tmp_path):
    path = tmp_path / "file.py"
    path.write_text(source, encoding="utf-8")
    assert hard_to_read([path]) == hard / max(len(texts_of([path])), 1)


def test_folders_of_questions_stay_small():
    """A reader finds a file of trial/ and study/ by looking at a folder once."""
    assert largest_folder() <= MOST_FILES


def test_the_package_has_a_public_surface():
    assert importlib.import_module("mbkf").__all__


DOORS = {
    "mbkf/io/atomic.py": "the door of everything that is written",
    "mbkf/io/files_read.py": "the door of everything that is read",
    "mbkf/io/written.py": "looks at a file before it is replaced",
    "mbkf/io/leftovers.py": "holds a lock",
    "mbkf/io/hdf5.py": "seals a file that its writer has just made",
    "mbkf/io/paged.py": "pages of an array in an unfinished folder",
    "mbkf/kernel/declaration.py": "files of the package",
    "mbkf/viz/page.py": "files of installed packages",
    "mbkf/viz/language.py": "files of the package",
    "mbkf/model/body_file.py": "files of the package",
    "mbkf/app/exports.py": "reads what it has just written into a folder of its own",
    "mbkf/stream/run/report.py": "rewrites in place a file that it has opened by the door",
    "mbkf/io/imu/movella_dot.py": "looks at a file that the door has checked",
    "mbkf/io/imu/xsens_text.py": "looks at a file that the door has checked",
    "mbkf/stream/run/folder.py": "removes the log that the run has made",
    "mbkf/cli/opening.py": "removes a temporary file that it has made",
    "mbkf/conventions.py": "files of the package",
    "mbkf/cli/main.py": "opens the null device",
    "mbkf/cli/closed_streams.py": "opens the null device",
    "mbkf/study/batch/worker.py": "opens the null device",
    "mbkf/viz/meshcat/visualiser.py": "opens a browser",
}
"""Files that open others by themselves, each with its reason."""

NO_FILE = re.compile(r"(partial|temporary|Image|av|webbrowser|files_read|sets|waiting|self\._plates)\b")
"""Names of things that are no files, and of temporary files, which the door gave."""

OPENING = {
    "open",
    "read_text",
    "read_bytes",
    "write_text",
    "write_bytes",
    "touch",
    "unlink",
    "rmtree",
    "resolve",
}
"""Methods that open or remove a file, or raise an unforeseen error of a link to itself."""


def opened_directly(source: str) -> list[str]:
    """Calls that open or remove a file and pass neither door; a temporary file, which the door gave, may be opened."""
    found = []
    for node in ast.walk(parsed(source)):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in OPENING:
            of = ast.unparse(node.func.value)
            if NO_FILE.match(of) is None:
                found.append(ast.unparse(node.func))
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "open":
            found.append("open")
    return found


def test_files_are_read_and_written_by_two_doors():
    found = {relative(path): opened_directly(path.read_text(encoding="utf-8")) for path in SOURCES}
    assert {name: calls for name, calls in found.items() if calls and name not in DOORS} == {}
    assert {name for name, calls in found.items() if calls} == set(DOORS)


@pytest.mark.parametrize(
    ("source", "found"),
    [
        ("path.open('wb')", ["path.open"]),
        ("open(path)", ["open"]),
        ("(folder / 'a').unlink(missing_ok=True)", ["(folder / 'a').unlink"]),
        ("shutil.rmtree(folder)", ["shutil.rmtree"]),
        ("(folder / 'a').write_text('b')", ["(folder / 'a').write_text"]),
        ("partial.write_bytes(b'')", []),
        ("write_text(path, 'a')", []),
    ],
)
def test_the_rule_of_doors_sees_what_it_should(source, found):
    assert opened_directly(source) == found


def test_no_drawers():
    """A file called utils holds no idea of its own."""
    drawers = re.compile(r"_*(utils?|common|misc|helpers?|tools?)")
    named = [path.parent.name if path.name == "__init__.py" else path.stem for path in SOURCES]
    assert [name for name in named if drawers.fullmatch(name)] == []


def has_test_file(path: Path) -> bool:
    """The test file of the same name, or one in the mirrored folder that imports the module itself."""
    folder = TESTS / path.relative_to(PACKAGE).parent
    name = module_name(path)
    return (folder / f"test_{path.stem}.py").is_file() or any(
        found == name or found.startswith(f"{name}.")
        for test in folder.glob("test_*.py")
        for found in imports_of(test)
    )


def test_modules_have_their_test_files():
    """A module without one gets it, or is named in UNTESTED with a reason."""
    modules = [path for path in SOURCES if path.parent != PACKAGE and path.name != "__init__.py"]
    assert [relative(p) for p in modules if relative(p) not in UNTESTED and not has_test_file(p)] == []


def test_every_test_is_run():
    """A test without its prefix never runs: functions with assertions are tests or are called by one."""
    for path in sorted(TESTS.rglob("test_*.py")):
        tree = tree_of(path)
        unproven = {
            node.name
            for node in tree.body
            if isinstance(node, ast.FunctionDef)
            and not (node.name.startswith("test_") or node.decorator_list)
        }
        if unproven:
            nodes = list(ast.walk(tree))
            unproven -= {node.id for node in nodes if isinstance(node, ast.Name)}
            unproven -= {node.attr for node in nodes if isinstance(node, ast.Attribute)}
        assert not unproven, f"{relative(path)}: neither tests nor used"
