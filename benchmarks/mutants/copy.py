"""A copy of the tree in which mutants are tried, so that the tree itself never holds a wrong line."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from benchmarks.mutants.mutant import Mutant
from mbkf.errors import MbkfError

AT_THE_TOP = {".git", ".venv", "venv", "build", "dist", "results"}
"""Folders of the tree that are not copied; nor is any cache."""

LONGEST_S = 600.0
"""Tests that take longer than this are stopped, and have failed."""

PASSED, FAILED, NOT_COLLECTED = 0, 1, 2
COMPILE = "import sys; sys.path.insert(0, '.ci'); from build_hook import *; compiled(FOLDER.resolve())"


@dataclass(frozen=True)
class Copy:
    """A copy of the tree.

    Attributes:
        root: Its folder.
        environment: Variables of the tests that run in it.
    """

    root: Path
    environment: dict[str, str]

    @classmethod
    def of(cls, tree: Path, folder: str | Path, data: Path | None = None) -> Copy:
        """Copies a tree.

        Args:
            tree: The tree.
            folder: A folder that does not exist yet.
            data: Folder of the reference captures; without it their tests are skipped.
        """

        def left_out(where: str, names: list[str]) -> set[str]:
            caches = {name for name in names if name == "__pycache__" or name.endswith("_cache")}
            return caches | (AT_THE_TOP & set(names) if Path(where) == tree else set())

        root = Path(shutil.copytree(tree, folder, ignore=left_out))
        environment = {**os.environ, "PYTHONPATH": str(root), "OMP_NUM_THREADS": "1"}
        if data is not None:
            environment["MBKF_DATA"] = str(data)
        return cls(root, environment)

    def kills(self, mutant: Mutant) -> bool:
        """True where a test beside the mutant fails with it."""
        with self._changed(mutant):
            return bool(self.failure(mutant.tests))

    def failure(self, tests: Sequence[str]) -> str:
        """The first quick test that fails; empty where all pass.

        Args:
            tests: Files or folders.

        Raises:
            MbkfError: No test was run.
        """
        words = ("-m", "pytest", "-q", "-x", "-m", "not slow", "-p", "no:cacheprovider", "--tb=no", *tests)
        try:
            done = self._python(*words)
        except subprocess.TimeoutExpired:
            return f"not done after {LONGEST_S:.0f} s: {', '.join(tests)}"
        if done.returncode == PASSED:
            return ""
        named = [line for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
        if named and done.returncode in (FAILED, NOT_COLLECTED):
            return named[0]
        raise MbkfError(
            f"no quick test was run of {', '.join(tests)}: {done.stdout[-500:]}{done.stderr[-500:]}"
        )

    @contextmanager
    def _changed(self, mutant: Mutant) -> Iterator[None]:
        """The copy with a mutant in it."""
        path = self.root / mutant.file
        right = path.read_text(encoding="utf-8")
        self._write(path, right.replace(mutant.old, mutant.new))
        try:
            yield
        finally:
            self._write(path, right)

    def _write(self, path: Path, text: str) -> None:
        """Writes a source and removes or renews what was compiled from another text."""
        path.write_text(text, encoding="utf-8")
        for compiled in (path.parent / "__pycache__").glob(f"{path.stem}.*.pyc"):
            compiled.unlink()
        if path.suffix in {".c", ".h"}:
            done = self._python("-c", COMPILE)
            if done.returncode:
                raise MbkfError(f"{path.name} does not compile: {done.stderr[-500:]}")

    def _python(self, *words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, *words],
            capture_output=True,
            text=True,
            check=False,
            cwd=self.root,
            env=self.environment,
            timeout=LONGEST_S,
        )
