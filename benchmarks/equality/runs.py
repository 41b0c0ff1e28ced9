"""Runs the commands of one source tree and remembers what is already done."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from benchmarks.equality.captures import Captured, Run
from mbkf.errors import InvalidInput
from mbkf.kernel.loading import SWITCH

MAX_SECONDS = 1800.0
TREE_FILE = "tree.json"


@dataclass(frozen=True)
class Outcome:
    """How a command ended: 0 when its results lie in the folder, else its message."""

    code: int
    message: str
    folder: Path


@dataclass(frozen=True)
class Tree:
    """A source tree and the folder for what it writes.

    Attributes:
        source: Its top, where the package ``mbkf`` lies.
        out: Its results: per capture ``made`` with what was prepared, and one folder for each run.
        data: The reference captures.
        cached: Whether results that are there already are taken as they are.
        kernel: The kernel that its commands use; "" for what they choose themselves.
    """

    source: Path
    out: Path
    data: Path
    cached: bool
    kernel: str = ""

    def check(self) -> None:
        """Makes sure that commands run in this tree, and that cached results come from it as it is now.

        Raises:
            InvalidInput: They do not.
        """
        if not (self.source / "mbkf").is_dir():
            raise InvalidInput(f"{self.source}: no source tree of mbkf")
        self.out.mkdir(parents=True, exist_ok=True)
        words = [sys.executable, "-c", "import mbkf; print(mbkf.__file__)"]
        done = subprocess.run(
            words, cwd=self.out, env=self._environment(), capture_output=True, text=True, check=False
        )
        if not done.stdout.startswith(str(self.source)):
            raise InvalidInput(f"{self.source}: Python imports mbkf from '{done.stdout.strip()}' instead")
        note, digest = self.out / TREE_FILE, self._digest()
        if self.cached and note.is_file() and json.loads(note.read_text(encoding="utf-8")) != digest:
            raise InvalidInput(f"{self.out}: made by another source tree; remove it or give another --out")
        note.write_text(json.dumps(digest), encoding="utf-8")

    def prepare(self, capture: Captured) -> Outcome:
        """Runs a capture's preparation up to the first command that fails."""
        folder = self.out / capture.name / "made"
        commands = [[self._filled(word, folder) for word in words] for words in capture.prepare]
        return self._once(folder, commands)

    def follow(self, capture: Captured, run: Run, made: Path) -> Outcome:
        """Follows a capture in one way.

        Args:
            capture: The capture.
            run: Filter and mode.
            made: What was prepared for it, by whichever tree.
        """
        folder = self.out / capture.name / run.name
        words = [self._filled(word, made) for word in capture.words(run)]
        return self._once(folder, [[*words, "--out", str(folder)]])

    def _once(self, folder: Path, commands: list[list[str]]) -> Outcome:
        """The commands' outcome, from the last time where that is allowed and they were the same."""
        note = folder.with_name(folder.name + ".json")
        if self.cached and note.is_file():
            stored = json.loads(note.read_text(encoding="utf-8"))
            if stored["commands"] == commands:
                return Outcome(stored["code"], stored["message"], folder)
        shutil.rmtree(folder, ignore_errors=True)
        note.unlink(missing_ok=True)
        folder.mkdir(parents=True)
        code, message = 0, ""
        for words in commands:
            code, message = self._mbkf(words)
            if code:
                break
        if code >= 0:
            stored = {"commands": commands, "code": code, "message": message}
            note.write_text(json.dumps(stored, indent=1), encoding="utf-8")
        return Outcome(code, message, folder)

    def _mbkf(self, words: list[str]) -> tuple[int, str]:
        """Exit code and last line of the messages; a negative code where the command had to be ended."""
        try:
            done = subprocess.run(
                [sys.executable, "-m", "mbkf", *words],
                cwd=self.out,
                env=self._environment(),
                capture_output=True,
                text=True,
                check=False,
                timeout=MAX_SECONDS,
            )
        except subprocess.TimeoutExpired:
            return -1, f"no end after {MAX_SECONDS:.0f} s"
        lines = done.stderr.strip().splitlines()
        return done.returncode, lines[-1] if done.returncode and lines else ""

    def _environment(self) -> dict[str, str]:
        """One thread per process, so that sums are taken in one order and workers do not disturb each other."""
        threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
        kernel = {SWITCH: self.kernel} if self.kernel else {}
        source = {"PYTHONPATH": str(self.source), "PYTHONDONTWRITEBYTECODE": "1"}
        return {**os.environ, **threads, **kernel, **source}

    def _filled(self, word: str, made: Path) -> str:
        return word.replace("{data}", str(self.data)).replace("{made}", str(made))

    def _digest(self) -> str:
        files = (path for name in ("mbkf", "models", "markers") for path in (self.source / name).rglob("*"))
        state = sha256()
        for path in sorted(p for p in files if p.is_file() and p.suffix != ".pyc"):
            state.update(path.relative_to(self.source).as_posix().encode() + b"\0" + path.read_bytes())
        state.update(self.kernel.encode())
        return state.hexdigest()
