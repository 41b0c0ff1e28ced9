"""Every source that code, tests and benchmarks name can be followed by a reader of the repository."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
ENDINGS = {".css", ".html", ".js", ".md", ".py", ".toml"}
FOLDERS = ("mbkf", "tests", "benchmarks", "models", "markers")
FILES = sorted(
    path
    for path in [*(path for folder in FOLDERS for path in (ROOT / folder).rglob("*")), *ROOT.glob("*.*")]
    if path.suffix in ENDINGS and path != Path(__file__).resolve()
)

DOCUMENTS = re.compile(r"\b(?:SPEC|DESIGN|HOUSE|STYLE|PLAN)(?:\.md|\s*§|\s+\d)|\bfacts? \d")
"""Documents that do not ship, and numbered facts of theirs."""
EQUATION = re.compile(r"\b[Ee]q(?:uation)?s?\.?\s\(?\d")
SOURCE = re.compile(
    r"(?:\b[Tt]hesis|\bMadgwick(?: 2010,)?|\bstride|\(\d{4}\),|arXiv:[\d.]+,|``Madgwick``\),)\s*$"
    r"|[\d.]+,? and\s*$"
)
"""What stands before a numbered equation: a work of docs/references.md, or a citation."""


def unsourced(text: str) -> list[str]:
    """References that cannot be followed: documents that do not ship, equations of no named work."""
    found = [match.group() for match in DOCUMENTS.finditer(text)]
    for match in EQUATION.finditer(text):
        after = text[match.end() : match.end() + 60]
        if not SOURCE.search(text[: match.start()]) and "docs/references.md" not in after:
            found.append(match.group())
    return found


def test_references_can_be_followed():
    found = {path.relative_to(ROOT): unsourced(path.read_text(encoding="utf-8")) for path in FILES}
    assert {path: faults for path, faults in found.items() if faults} == {}


@pytest.mark.parametrize(
    ("text", "faults"),
    [
        ("as in eq. 3.7", 1),
        ("as in thesis eq. 3.7", 0),
        ("Thesis eqs. 3.1–3.3", 0),
        ("(equation 4)", 1),
        ("IEEE Trans. 57 (2010), eq. 9", 0),
        ("(SPEC §5)", 1),
        ("see DESIGN 4", 1),
        ("fact 12", 1),
        ("a design of 4 markers", 0),
    ],
)
def test_the_rule_of_references_sees_what_it_should(text, faults):
    assert len(unsourced(text)) == faults
