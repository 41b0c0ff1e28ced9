"""The report's table of checks without the filter: value, range that noise explains, verdict."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from mbkf.io.findings import INSIDE_SD, Finding
from mbkf.io.verdict import Verdict
from mbkf.trial.verdict.restated import stated

SIGNS = {"inside": "✓", "doubtful": "!", "outside": "✗", "not judged": "–"}
KINDS = {"inside": "good", "doubtful": "care", "outside": "bad", "not judged": "none"}
SEE_REASONS = "see the reasons of the verdict"
ORDER = ("outside", "doubtful", "inside", "not judged")


def findings_table(checks: Sequence[Finding], verdict: Verdict) -> str:
    """The table, worst first; empty without checks.

    Args:
        checks: The checks.
        verdict: The verdict on the trial; what its reasons state is not repeated.
    """
    if not checks:
        return ""
    ranked = sorted(checks, key=lambda one: ORDER.index(one.verdict))
    rows = "".join(_row(one, stated(one.name, verdict)) for one in ranked)
    heads = "".join(
        f"<th>{text}</th>" for text in ("Check", "", "found", "noise explains", "bound", "meaning")
    )
    return (
        "<h3>Checks without the filter</h3><p>Markers, plates and clocks against each other, before a filter makes "
        "them agree. A tick means that noise explains the value.</p>"
        f'<table class="checks"><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>'
    )


def _row(one: Finding, known: bool) -> str:
    value = "–" if one.value is None else f"{one.value:.3g} {one.unit}"
    noise = "–" if one.expected_sd is None else f"± {INSIDE_SD * one.expected_sd:.2g} {one.unit}"
    cells = (
        one.name,
        SIGNS[one.verdict],
        value,
        noise,
        f"{one.bound:g} {one.unit}",
        SEE_REASONS if known else one.hint,
    )
    kind = KINDS[one.verdict]
    return (
        f'<tr class="{kind}" title="{escape(one.verdict)}">'
        + "".join(f"<td>{escape(text)}</td>" for text in cells)
        + "</tr>"
    )
