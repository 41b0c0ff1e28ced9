"""Texts that a person reads on a page, and faults in them: English on Spanish pages, points, technical words."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from html import unescape

from mbkf.viz.language import words

SPOKEN = re.compile(r'\s(?:title|aria-label|placeholder|alt)="([^"]*)"')
SILENT = ("script", "style", "code")
VOID = ("br", "img", "input", "meta", "link", "hr")

SECTIONS = (
    "app", "session_report", "measures", "units", "joints", "coordinates", "positive", "clinical_coordinates",
    "clinical_positive", "internal_moments", "external_moments", "convention", "left_out_of_norms", "chart_choices",
    "live", "live_page", "marker_set_page", "export", "viewer", "problems", "sentences",
    "norms", "visit", "sheet", "muscles",
)  # fmt: skip
"""Sections of the language files whose words are compared."""

FUNCTION_WORDS = frozenset(
    [
        "the",
        "of",
        "and",
        "is",
        "are",
        "was",
        "were",
        "with",
        "from",
        "which",
        "not",
        "this",
        "that",
        "by",
        "for",
        "to",
        "be",
        "been",
        "its",
        "it",
        "their",
        "they",
        "has",
        "have",
        "had",
        "where",
        "when",
        "while",
        "there",
        "than",
        "then",
        "each",
        "both",
        "other",
    ]
)
"""English words that no Spanish text has."""

TECHNICAL = (
    r"--\w", r"\bmbkf (?:app|live|label|scale|reconstruct|batch|norms|report|export|info|protocol|synth)\b",
    r"\b(?:innovations?|NIS|NEES|SVD|dofs?|covariance|Jacobian|quaternions?|transducers?|ORIGIN|CORNERS|CAL_MATRIX)\b",
    r"\b(?:POINT|ANALOG|FORCE_PLATFORM):\w", r"\b(?:stdin|stdout|stderr|traceback|exception|None|NaN|JSON|regex)\b",
    r"\bnot positive definite\b", r"\blikelihood\b", r"\bstate vector\b", r"\bgate\b", r"\bresidual_\w+", r"\w+\(\)",
    r"\b(?:innovaci[oó]n|innovaciones|covarianza|jacobiano|cuaterni[oó]n\w*|transductor\w*)\b",
    r"\b(?:right|left)_\w+_[xyz]\b", r"\bsubject\.toml\b", r"\bpip install\b",
)  # fmt: skip
"""Words of options, of the command line and of the computation that a page may not show."""

_TECHNICAL = re.compile("|".join(TECHNICAL))
_POINT = re.compile(r"(?<![\w.])\d+\.\d+(?![\w.]*\w)")
_WORD = re.compile(r"[^\W\d_]{2,}")
_WITH_DIGITS = re.compile(r"\d+(?:[.,]\d+)?")


def texts_of(html: str) -> Iterator[str]:
    """Texts and spoken attributes of a page, without code and what is not to be translated."""
    open_elements: list[str] = []
    for k, piece in enumerate(re.split(r"(<!--.*?-->|<[^<>]*>)", html, flags=re.S)):
        if k % 2 == 0:
            if not open_elements and piece.strip():
                yield unescape(piece.strip())
            continue
        if not open_elements:
            yield from (unescape(one) for one in SPOKEN.findall(piece) if one.strip())
        named = re.match(r"</?([\w-]+)", piece)
        if named is None or piece.endswith("/>") or named[1] in VOID:
            continue
        if piece.startswith("</"):
            if open_elements and open_elements[-1] == named[1]:
                open_elements.pop()
        elif open_elements or named[1] in SILENT or re.search(r"translate=.no", piece):
            open_elements.append(named[1])


def english(text: str, names: Iterable[str] = ()) -> list[str]:
    """Words of a text that the English texts have and the Spanish ones have not.

    Args:
        text: Of a Spanish page.
        names: Names of trials and files, which are in no language.
    """
    for name in sorted(names, key=len, reverse=True):
        text = text.replace(name, " ")
    return [one for one in _WORD.findall(text.lower()) if one in _english_words()]


def decimal_points(text: str) -> list[str]:
    """Numbers with a decimal point."""
    return _POINT.findall(text)


def technical(text: str) -> list[str]:
    """Technical words of a text."""
    return [found[0] for found in _TECHNICAL.finditer(text)]


def stated_twice(problems: Sequence[str]) -> list[tuple[str, str]]:
    """Pairs of problems of one page that are the same text, or share two numbers or more and most of them."""
    found = []
    for k, one in enumerate(problems):
        for other in problems[:k]:
            a, b = (set(_WITH_DIGITS.findall(text)) for text in (one, other))
            shared = len(a & b)
            if one == other or (shared >= 2 and shared >= 0.6 * min(len(a), len(b))):
                found.append((other, one))
    return found


@cache
def _english_words() -> frozenset[str]:
    def vocabulary(code: str) -> set[str]:
        texts = (text for section in SECTIONS for text in words(code, section).values())
        return {one for text in texts for one in _WORD.findall(text.lower())}

    return frozenset((vocabulary("en") | FUNCTION_WORDS) - vocabulary("es"))
