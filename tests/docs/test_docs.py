"""The documentation builds without a warning, its code works, and it names everything a user can set or read."""

import dataclasses
import re
import shlex
import subprocess
import sys
import typing
from pathlib import Path

import pytest

import mbkf
from docs._extensions import edited_files, public_surface, result_quantities
from mbkf.cli.main import build_parser
from mbkf.model.protocol import protocol_names

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PAGES = sorted(DOCS.rglob("*.md"))


def relative(path: Path) -> str:
    return path.relative_to(DOCS).as_posix()


def blocks(page: Path, *kinds: str) -> list[str]:
    found = re.findall(r"^```(\w+)\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    return [text for kind, text in found if kind in kinds]


SHELL_LINES = [
    line.split("  #")[0]
    for page in PAGES
    for text in blocks(page, "sh")
    for line in text.splitlines()
    if line.startswith("mbkf ")
]
PYTHON_BLOCKS = [
    pytest.param(text, id=f"{relative(page)}-{k}")
    for page in PAGES
    for k, text in enumerate(blocks(page, "python"))
]


def test_every_entry_of_an_edited_file_stands_in_the_page_on_them():
    text = (DOCS / "edited_files.md").read_text(encoding="utf-8")
    assert set(re.findall(r"```\{entries\} (.+)", text)) == set(edited_files.RECORDS)
    for name, record in edited_files.RECORDS.items():
        rows = edited_files.entry_rows(name)[2:]
        assert [row.split("|")[1].strip(" `") for row in rows] == list(record.keys)
        assert all(len(row.split("|")) == 5 and "None" not in row for row in rows)


@pytest.mark.slow
def test_pages_build_without_a_warning_and_load_nothing(tmp_path):
    words = ["-m", "sphinx", "-W", "--keep-going", "-q", "-b", "html", "-d", tmp_path / "trees"]
    done = subprocess.run(
        [sys.executable, *words, DOCS, tmp_path / "html"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    for page in (tmp_path / "html").rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        assert not re.findall(r'<(?:script|img|link)[^>]+(?:src|href)="(?:https?:)?//[^"]+"', text), page


def test_commands_are_understood():
    """A command that is not ends this test with the parser's message."""
    parser = build_parser()
    for line in SHELL_LINES:
        parser.parse_args(shlex.split(line)[1:])


@pytest.mark.parametrize("source", PYTHON_BLOCKS)
def test_python_runs(source, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    exec(compile(source, "docs", "exec"), {"__name__": "__main__"})


def test_no_page_is_empty_and_every_example_that_a_page_shows_exists():
    texts = {page: page.read_text(encoding="utf-8") for page in PAGES}
    assert [relative(page) for page, text in texts.items() if not text.startswith("# ")] == []
    shown = [(page, name) for page in PAGES for name in re.findall(r"\{literalinclude\} (\S+)", texts[page])]
    assert [(relative(page), name) for page, name in shown if not (page.parent / name).is_file()] == []


def test_every_public_name_stands_on_one_page_of_the_reference():
    named = [name for names in public_surface.TOPICS.values() for name in names]
    assert sorted(named) == sorted(set(mbkf.__all__) - {"__version__"})
    pages = {path.stem: path.read_text(encoding="utf-8") for path in (DOCS / "api").glob("*.rst")}
    listed = pages.pop("index").partition(".. toctree::")[2].split()[2:]
    assert listed == list(public_surface.TOPICS) and set(listed) == set(pages)
    assert [name for name in listed if f".. public-surface:: {name}\n" not in pages[name]] == []


def settings(value: object) -> dict[str, object]:
    """Every setting of a record and of the records in it, with its default."""
    found: dict[str, object] = {}
    for one in dataclasses.fields(value):  # type: ignore[arg-type]
        default = getattr(value, one.name)
        found |= settings(default) if dataclasses.is_dataclass(default) else {one.name: default}
    return found


def test_every_setting_stands_in_the_page_on_tuning():
    text = (DOCS / "tuning.md").read_text(encoding="utf-8")
    assert [name for name in settings(mbkf.ReconstructSettings()) if f"`{name}`" not in text] == []


def test_every_dataset_of_a_result_stands_in_the_page_on_files():
    text = (DOCS / "files.md").read_text(encoding="utf-8")
    assert "```{result-quantities}" in text and "```{result-attributes}" in text
    rows = [*result_quantities.quantity_rows(), *result_quantities.attribute_rows()]
    named = [name for row in rows for name in re.findall(r"`(\w+)`", row.split("|")[1])]
    result = typing.get_type_hints(mbkf.read_reconstruction)["return"]
    missing = {one.name for one in dataclasses.fields(result)} - set(named)
    assert missing == {"subject", "covariance"}  # an attribute that the page explains, and one never written
    assert len(set(named)) == len(named)
    for label in {label for row in rows for label in re.findall(r"\{ref\}`more <([\w-]+)>`", row)}:
        assert any(f"({label})=" in path.read_text(encoding="utf-8") for path in DOCS.rglob("*.md")), label


@pytest.mark.slow
def test_every_key_of_the_summary_stands_in_the_page_on_files():
    text = (DOCS / "files.md").read_text(encoding="utf-8")
    subject, recorded = mbkf.synthesise("squat", seconds=1.0)
    summary = mbkf.summarise(mbkf.reconstruct(recorded.trial, subject), recorded.truth)
    assert {*summary, *summary["truth"]} - set(re.findall(r"`(\w+)`", text)) == set()


CITED = re.compile(r"\(((?:[A-Z][\w-]+ )?[A-Z][\w-]+)(?: (?:&|and) [A-Z][\w-]+| et al\.)? ((?:19|20)\d\d)\b")


def test_every_paper_that_the_code_cites_stands_among_the_references():
    text = (DOCS / "references.md").read_text(encoding="utf-8")
    cited = {
        f"{name} {year}": path.relative_to(ROOT)
        for path in (ROOT / "mbkf").rglob("*.py")
        for name, year in CITED.findall(path.read_text(encoding="utf-8"))
    }
    assert len(cited) > 5
    assert {key: path for key, path in cited.items() if f"**{key}**" not in text} == {}


def test_the_citation_names_this_version():
    assert f"version: {mbkf.__version__}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


def test_the_page_on_marker_sets_lists_every_shipped_one():
    page = (DOCS / "own_marker_set.md").read_text(encoding="utf-8")
    rows = [
        line.split("|")[1]
        for line in page.partition("Each file names")[0].splitlines()
        if line.startswith("| `")
    ]
    assert sorted(re.findall(r"`(\w+)`", " ".join(rows))) == list(protocol_names())
