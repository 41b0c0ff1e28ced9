"""A mutant: a text of one file, the wrong text in its place, and the tests that should see the difference."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

from benchmarks.house.circles import imports_of, module_name
from mbkf.errors import InvalidInput

ROOT = Path(__file__).resolve().parents[2]
LIST = Path(__file__).with_name("mutants.toml")


@dataclass(frozen=True)
class Mutant:
    """One wrong text.

    Attributes:
        file: The changed file, from the top of the tree.
        old: Its text, which it holds exactly once.
        new: The wrong text.
        tests: Files or folders of tests beside it.
    """

    file: str
    old: str
    new: str
    tests: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.file}: {' '.join(self.old.split())} -> {' '.join(self.new.split())}"


def read_mutants(path: Path = LIST, root: Path = ROOT) -> list[Mutant]:
    """The mutants of a list; the tests of one that names none are those beside its file.

    Args:
        path: The list.
        root: Folder of the tree.

    Raises:
        InvalidInput: A mutant changes nothing, or no test is beside its file.
    """
    found = []
    for entry in tomllib.loads(path.read_text(encoding="utf-8"))["mutant"]:
        tests = entry.get("tests") or mirrored_tests(root / entry["file"], root)
        found.append(Mutant(entry["file"], entry["old"], entry["new"], tuple(tests)))
        if not tests and (root / entry["file"]).is_file():
            raise InvalidInput(f"{path.name}: no test stands beside {entry['file']}; name its tests")
        if entry["old"] == entry["new"]:
            raise InvalidInput(f"{path.name}: a mutant of {entry['file']} changes nothing")
    return found


def mirrored_tests(path: Path, root: Path = ROOT) -> list[str]:
    """Test files of a module of mbkf: the one of its name, and those of the mirrored folder that import it.

    Args:
        path: The module's file; every other file has the mirrored folder itself.
        root: Folder of the tree.
    """
    folder = root / "tests" / path.relative_to(root / "mbkf").parent
    if path.suffix != ".py":
        return [folder.relative_to(root).as_posix()]
    name = module_name(path, root)
    return [
        test.relative_to(root).as_posix()
        for test in sorted(folder.glob("test_*.py"))
        if test.stem == f"test_{path.stem}" or _imports(test, name, root)
    ]


def _imports(test: Path, name: str, root: Path) -> bool:
    """True for a file that imports a module, or one below it; only files with its last name are parsed."""
    if name.rpartition(".")[2] not in test.read_text(encoding="utf-8"):
        return False
    return any(found == name or found.startswith(f"{name}.") for found in imports_of(test, root))


def times_found(mutant: Mutant, root: Path) -> int:
    """Number of times that a mutant's text stands in its file; 0 for a missing file."""
    path = root / mutant.file
    return path.read_text(encoding="utf-8").count(mutant.old) if path.is_file() else 0
