"""Libraries and captures of a benchmark are looked for before it starts; one line names those that it lacks."""

import ast
import re
import subprocess
import sys
import tomllib
from functools import cache
from pathlib import Path

import pytest

from benchmarks import __main__ as runner
from benchmarks import needs
from benchmarks.needs import EXTRAS, NEEDS, Lacking, absent, require

ROOT = Path(__file__).parents[2]
PAGE = ROOT / needs.PAGE
ALIASES = {"pillow": "PIL", "myst-parser": "myst_parser", "axe-playwright-python": "axe_playwright_python"}
"""Modules that are not called as the package that brings them."""

IMPORT_ALL = """
import importlib, sys

class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in BLOCKED:
            raise ModuleNotFoundError(name)

BLOCKED = set(sys.argv[1].split(","))
sys.meta_path.insert(0, Blocked())
from benchmarks.__main__ import names
for name in names():
    module = importlib.import_module(f"benchmarks.{name}")
    assert module.__doc__ and callable(module.run), name
print(len(names()))
"""


@cache
def extras() -> dict[str, set[str]]:
    """Modules by extra of pyproject.toml, those of extras inside it among them."""
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]

    def modules(extra):
        found = set()
        for requirement in declared[extra]:
            if inner := re.fullmatch(r"mbkf\[(.*)\]", requirement):
                found |= set().union(*(modules(one) for one in inner[1].split(",")))
            else:
                name = re.match(r"[\w-]+", requirement)[0]
                found.add(ALIASES.get(name, name.replace("-", "_")))
        return found

    return {extra: modules(extra) for extra in declared}


@cache
def imported(module: str) -> tuple[frozenset[str], frozenset[str], frozenset[str]]:
    """Modules of benchmarks and optional libraries that a module imports anywhere, and captures that it names."""
    place = ROOT / module.replace(".", "/")
    path = place / "__init__.py" if place.is_dir() else place.with_suffix(".py")
    source = path.read_text(encoding="utf-8")
    words = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            words |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            words |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    own = {one for one in words if one.startswith("benchmarks") and _exists(one)}
    own |= {one.rsplit(".", 1)[0] for one in own if "." in one}
    libraries = {one.split(".")[0] for one in words} & set(EXTRAS)
    captures = re.findall(rf"\b({'|'.join(sorted(folders()))})\b", source)
    return frozenset(own), frozenset(libraries), frozenset(captures)


def _exists(module: str) -> bool:
    place = ROOT / module.replace(".", "/")
    return place.with_suffix(".py").is_file() or (place / "__init__.py").is_file()


def own_modules(name: str) -> list[str]:
    """The modules of a benchmark's own folder."""
    folder = ROOT / "benchmarks" / name
    if not folder.is_dir():
        return [f"benchmarks.{name}"]
    return [
        f"benchmarks.{path.relative_to(ROOT / 'benchmarks').with_suffix('').as_posix().replace('/', '.')}"
        for path in folder.rglob("*.py")
        if path.stem not in {"__init__", "__main__"}
    ] + [f"benchmarks.{name}"]


def reached(name: str) -> set[str]:
    """Modules of benchmarks that a benchmark imports, and those that these import."""
    found, todo = set(), own_modules(name)
    while todo:
        one = todo.pop()
        if one not in found and one not in {"benchmarks.__main__", "benchmarks.needs"}:
            found.add(one)
            todo += imported(one)[0]
    return found


@cache
def folders() -> frozenset[str]:
    """Folders of captures that the page lists."""
    return frozenset(re.findall(r"^\| `(\w+)`", PAGE.read_text(encoding="utf-8"), re.MULTILINE))


@pytest.mark.parametrize("name", runner.names())
def test_captures_of_a_benchmark_are_those_of_its_sources(name):
    own = set().union(*(imported(module)[2] for module in own_modules(name)))
    every = set().union(*(imported(module)[2] for module in reached(name)))
    listed = set(needs.needs(name).captures)
    assert own - listed == set()
    assert listed - every == set()


@pytest.mark.parametrize("name", runner.names())
def test_libraries_that_a_benchmark_imports_are_those_that_it_states(name):
    own = set().union(*(imported(module)[1] for module in own_modules(name)))
    stated = needs.needs(name)
    pages = {"matplotlib"} if name == "foreign" else set()  # python -m benchmarks.foreign --page
    assert own - pages <= {*stated.libraries, *stated.some_rows}


def test_the_extra_that_is_named_brings_the_library():
    assert {library: extra for library, extra in EXTRAS.items() if library not in extras()[extra]} == {}
    assert {one for stated in NEEDS.values() for one in (*stated.libraries, *stated.some_rows)} == set(EXTRAS)
    assert set(NEEDS) <= set(runner.names())


def test_every_benchmark_can_be_imported_after_a_plain_installation_and_says_what_it_measures():
    optional = set().union(*extras().values()) - {"setuptools", "PIL"}  # meshcat brings Pillow
    done = subprocess.run(
        [sys.executable, "-c", IMPORT_ALL, ",".join(sorted(optional))],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.stdout.split(), done.stderr) == ([str(len(runner.names()))], "")


def test_a_missing_library_is_one_line_with_its_extra_before_any_work(monkeypatch, tmp_path, capsys):
    monkeypatch.setitem(NEEDS, "inertial", needs.Needs(("matplotlib", "vqf")))
    monkeypatch.setattr(needs, "installed", lambda module: module not in {"vqf", "matplotlib"})
    monkeypatch.setattr(runner.importlib, "import_module", lambda name: pytest.fail(f"{name} has begun"))
    assert runner.main(["inertial", "--data", str(tmp_path), "--out", str(tmp_path / "out")]) == 2
    line = "benchmarks: error: inertial needs matplotlib, vqf: pip install '.[figures,peers]'\n"
    assert capsys.readouterr().err == line
    assert not (tmp_path / "out" / "inertial").exists()


def test_a_module_is_looked_for_without_being_loaded():
    assert needs.installed("this") and "this" not in sys.modules
    assert not needs.installed("no_such_module")
    assert not needs.installed("no_such_module.inside")


def test_missing_captures_are_named_with_the_page_that_states_where_to_get_them(tmp_path):
    with pytest.raises(
        Lacking, match=r"angles needs captures \(biomechzoo_walk_turn, cgm24_\w+\); docs/capt"
    ):
        require("angles", None)
    (tmp_path / "cgm24_lowerlimb_walk").mkdir()
    assert absent(needs.needs("angles").captures, tmp_path) == ("biomechzoo_walk_turn",)
    with pytest.raises(Lacking, match=r"\(biomechzoo_walk_turn\)"):
        require("angles", tmp_path)
    assert "--quick needs some of them" in require("angles", tmp_path, quick=True)
    (tmp_path / "biomechzoo_walk_turn").mkdir()
    assert require("angles", tmp_path) == ""


def test_a_benchmark_with_synthetic_rows_runs_without_captures_and_says_so():
    assert "full_body needs captures (biomechzoo_walk_turn" in (line := require("full_body", None))
    assert line.endswith("their rows are left out")
    assert require("synthesis_time", None) == ""


def test_the_page_states_which_benchmarks_need_a_capture():
    stated = dict(
        re.findall(r"^\| `(\w+)` \|[^|]*\| ([^|]*?) \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    )
    by_capture = {
        folder: ", ".join(f"`{name}`" for name in sorted(NEEDS) if folder in NEEDS[name].captures)
        for folder in folders()
    }
    assert stated == {folder: names or "–" for folder, names in by_capture.items()}


def test_every_folder_that_benchmarks_and_tests_read_stands_on_the_page(real_data):
    held = {path.name for path in real_data.iterdir() if path.is_dir()}
    used = "".join(
        path.read_text(encoding="utf-8")
        for top in ("benchmarks", "tests")
        for path in (ROOT / top).rglob("*.py")
    )
    assert {one for one in held - folders() if re.search(rf"\b{one}\b", used)} == set()
    assert {one for stated in NEEDS.values() for one in stated.captures} <= folders()
