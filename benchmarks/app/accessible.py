"""Accessibility of every page by axe-core."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from typing import Any

from benchmarks.app.pages_of import every_page
from benchmarks.app.visit import Visit
from benchmarks.checks import Check
from mbkf.errors import MissingDependency

SERIOUS = ("serious", "critical")


def accessible_rows(user: Visit) -> list[Check]:
    """A row for each page of a session that was run.

    Args:
        user: A visit that shows it.
    """
    return [
        Check(f"axe-core, {name}: serious findings", sum(len(findings(frame)) for frame in frames), 0.0, "<=")
        for name, frames in every_page(user)
    ]


def start_row(user: Visit) -> Check:
    """The row of the page before anything was dropped.

    Args:
        user: A visit that shows it.
    """
    return Check(
        "axe-core, nothing dropped yet: serious findings", len(findings(user.page.main_frame)), 0.0, "<="
    )


def findings(frame: Any) -> list[str]:
    """What axe-core finds serious or critical in a frame: the rule and the first place.

    Raises:
        MissingDependency: axe-core is not installed.
    """
    frame.evaluate(f"(() => {{ {axe_script()}\n }})()")
    found = frame.evaluate("axe.run(document, { iframes: false })")
    return [
        f"{one['id']}: {one['nodes'][0]['html'][:120]}"
        for one in found["violations"]
        if one["impact"] in SERIOUS
    ]


@cache
def axe_script() -> str:
    """axe-core's source.

    Raises:
        MissingDependency: It is not installed.
    """
    try:
        return (files("axe_playwright_python") / "axe.min.js").read_text(encoding="utf-8")
    except (ModuleNotFoundError, OSError) as error:
        raise MissingDependency("axe-playwright-python", "brings axe-core", "test") from error
