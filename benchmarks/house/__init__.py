"""Bounds of the source tree itself: files of one step, extensions by users, documentation, prose, folders, circles.

No reference captures are needed. The time of a step is compared with another tree's where one is given: ``--old TREE``.
"""

from __future__ import annotations

import re
from pathlib import Path

from benchmarks.checks import Check, Context
from benchmarks.house import step_time
from benchmarks.house.circles import circles
from benchmarks.house.documentation import documentation
from benchmarks.house.examples import body_rows, loop_rows, ran, sensor_rows
from benchmarks.house.folders import MOST_FILES, largest_folder
from benchmarks.house.prose import MOST_HARD, hard_to_read
from benchmarks.house.step_files import PACKAGE, READ, ROOT, executed_in_a_step, listed, undeclared

OWN_BLOCK = "DriftingTracker"
"""A block that stands in tests/blocks and is registered nowhere."""


def run(context: Context) -> list[Check]:
    """All rows."""
    checks = step_rows()
    checks += sensor_rows(context.out) + loop_rows(context.out) + body_rows(context.out)
    checks += block_rows()
    found = documentation()
    checks += [
        Check("public definitions without docstring", len(found.undocumented), 0, "<="),
        Check("functions of three or more arguments without Args", len(found.without_arguments), 0, "<="),
        Check(
            "docstrings and messages: share hard to read",
            hard_to_read(PACKAGE.rglob("*.py")),
            MOST_HARD,
            "<=",
        ),
        Check("trial/ and study/: files in the largest folder", largest_folder(), MOST_FILES, "<=", "files"),
        Check("files in a circle of imports", len(set(circles())), 0, "<="),
        Check("warnings while the documentation is built", documentation_warnings(context.out), 0, "<="),
    ]
    if context.old is not None:
        pairs = step_time.QUICK_PAIRS if context.quick else step_time.PAIRS
        checks += step_time.rows(context.old, context.out / "squat", pairs)
    return checks


def step_rows() -> list[Check]:
    """Files and lines of one dynamic step, and that the page's lists are complete."""
    files = listed(READ)
    return [
        Check("one dynamic step: files to open", len(files), 11, "<=", "files"),
        Check("one dynamic step: their lines", sum(one.lines for one in files), 1800, "<=", "lines"),
        Check(
            "one dynamic step: executed files in neither list",
            len(undeclared(executed_in_a_step())),
            0,
            "<=",
            "files",
        ),
    ]


def block_rows() -> list[Check]:
    """Tests that find a block of the tests' own by themselves."""
    return [
        Check(f"a block of a test's own: its {what} tests", tests_of(OWN_BLOCK, path), 1, ">=", "tests")
        for what, path in (("contract", "tests/test_blocks.py"), ("derivative", "tests/test_jacobians.py"))
    ]


def tests_of(name: str, path: str) -> int:
    """Tests of a file with that name among their parameters."""
    found = ran("-m", "pytest", "--collect-only", "-q", path, folder=ROOT)
    return named_in(found.output, name)


def named_in(collected: str, name: str) -> int:
    """Collected tests with that name among their parameters."""
    return len(re.findall(rf"^\S+\[[^\]]*\b{name}\b[^\]]*\]$", collected, re.MULTILINE))


def documentation_warnings(folder: Path) -> float:
    """Warnings of a build from scratch; NaN where it fails altogether."""
    pages = folder / "html"
    words = ("-m", "sphinx", "-E", "-q", "-b", "html", "-d", folder / "trees", ROOT / "docs", pages)
    built = ran(*words, folder=ROOT)
    if not built.worked:
        return float("nan")
    return len(re.findall(r"\b(?:WARNING|ERROR|CRITICAL):", built.output))
