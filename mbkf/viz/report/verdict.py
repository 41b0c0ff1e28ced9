"""The report's first lines: the verdict on the trial, its parts and its reasons."""

from __future__ import annotations

from html import escape

from mbkf.io.verdict import TITLES, WORDS, Verdict, listed
from mbkf.viz.markup import table

KINDS = dict(zip(WORDS, ("good", "care", "bad"), strict=True))
"""CSS class of each word."""


def verdict_banner(verdict: Verdict) -> str:
    """The word, the words on all parts, and all reasons, alike ones of several parts together.

    Args:
        verdict: The verdict.
    """
    hidden = [part for part in TITLES if part not in verdict.shown]
    parts = "".join(
        f'<span class="part {"none" if part in hidden else KINDS[word]}"><b>{escape(TITLES[part])}</b> '
        f"{'not shown' if part in hidden else word}</span>"
        for part, word in verdict.parts.items()
    )
    alike: dict[tuple[str, ...], list[str]] = {}
    for one in verdict.reasons:
        if one.part in verdict.shown:
            alike.setdefault((one.word, one.found, one.means, one.do), []).append(one.part)
    rows = [(listed(parts_of), *texts) for texts, parts_of in alike.items()]
    reasons = table(("part", "word", "found", "meaning", "what to do"), rows, "reasons") if rows else ""
    lines = f'<p class="line">{escape(verdict.overall)}</p><p class="parts">{parts}</p>'
    return f'<div id="verdict" class="verdict {KINDS[verdict.overall]}">{lines}{reasons}</div>'
