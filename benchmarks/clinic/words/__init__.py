"""Words of pages and reports: both languages, no technical words, decimals of the language, each problem once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from benchmarks.checks import Check
from benchmarks.clinic.words.library import unsaid
from benchmarks.clinic.words.pages import Read, read_pages
from benchmarks.clinic.words.scripts import untranslated
from benchmarks.clinic.words.texts import SECTIONS, decimal_points, english, stated_twice, technical
from mbkf.viz.language import ENGLISH, languages, words

REPORT_FILE = "words.txt"
"""Every text that a row counts, in the benchmark's folder."""

PRODUCTS = ("mbkf", "Plug-in Gait", "OpenSim", "Motive", "NatNet", "LSL", "EMG", "HTML", "live")
"""Names that are in no language."""


def words_rows(data: Path, out: Path) -> Iterator[Check]:
    """The rows; texts that they count stand in a file of the folder.

    Args:
        data: The shared captures.
        out: An empty folder.
    """
    faults: list[str] = []
    yield _both_languages(faults)
    read, names, numbers = read_pages(data, out)
    known = {*names, *PRODUCTS}
    shown = [(one.page, text) for one in read for text in one.texts]
    yield Check("texts read on Spanish pages", len({text for _, text in shown}), 1000, ">=")
    found: dict[str, Callable[[str], list[str]]] = {
        "English words left on Spanish pages": lambda text: english(text, known),
        "decimal points on Spanish pages": lambda text: [] if text.endswith(".c3d") else decimal_points(text),
        "technical words on Spanish pages": technical,
    }
    for name, faults_in in found.items():
        yield Check(name, _counted(name, shown, faults_in, faults), 0, "<=")
    stored = [
        (code, text) for code in languages() for section in SECTIONS for text in words(code, section).values()
    ]
    yield Check(
        "technical words in the language files", _counted("stored", stored, technical, faults), 0, "<="
    )
    yield Check("problems stated twice on a page", _twice(read, faults), 0, "<=")
    yield Check('ways of writing 64.2 that are taken: "64,2" and "64.2"', sum(numbers), 2, ">=")
    (out / REPORT_FILE).write_text("\n".join(faults), encoding="utf-8")


def _both_languages(faults: list[str]) -> Check:
    """Share of static texts that every language has: of files, of the library's code, of scripts and pages."""
    lacking: list[str] = []
    files = [(section, name) for section in SECTIONS for name in words(ENGLISH, section)]
    for code in languages():
        lacking += [f"{code}: {name}" for section, name in files if not words(code, section).get(name)]
    counted = len(files)
    for count, found in (unsaid(), untranslated()):
        counted += count
        lacking += found
    faults += [f"in one language alone: {one}" for one in lacking]
    return Check("static texts in both languages", 100.0 * (1.0 - len(lacking) / counted), 100, ">=", "%")


def _counted(
    name: str, shown: Iterable[tuple[str, str]], faults_in: Callable[[str], list[str]], faults: list[str]
) -> int:
    """Number of texts with a fault, each text once."""
    count, seen = 0, set()
    for page, text in shown:
        if text not in seen and (wrong := faults_in(text)):
            count += 1
            faults.append(f"{name}: {page}: {text} {wrong}")
        seen.add(text)
    return count


def _twice(read: Iterable[Read], faults: list[str]) -> int:
    count = 0
    for one in read:
        for first, second in stated_twice(one.problems):
            count += 1
            faults.append(f"stated twice: {one.page}: {first} | {second}")
    return count
