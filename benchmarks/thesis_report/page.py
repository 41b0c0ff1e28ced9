"""One self-contained HTML page: a source text and measurement side by side, with a verdict per claim."""

from __future__ import annotations

import base64
import io
import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from benchmarks.thesis_report.contents import CANNOT_BE_HAD, Band, Claim, Sheet
from benchmarks.thesis_report.figures import Drawing

_STYLE = """
:root { --ink: #1b1f23; --soft: #5b636b; --line: #dfe2e5; --good: #1a7f45; --bad: #b3261e; --half: #9a6700; }
* { box-sizing: border-box; }
body { font: 15px/1.5 system-ui, sans-serif; color: var(--ink); max-width: 1120px; margin: 0 auto; padding: 2rem; }
h1 { font-size: 1.7rem; margin: 0 0 .3rem; } h2 { font-size: 1.25rem; margin: 2.4rem 0 .6rem; }
h3 { font-size: 1rem; margin: 1.6rem 0 .4rem; } p { max-width: 46rem; } .soft { color: var(--soft); }
nav a { margin-right: 1.1rem; color: inherit; } .wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: 13px; width: 100%; font-variant-numeric: tabular-nums; }
th { text-align: left; font-weight: 600; border-bottom: 2px solid var(--line); vertical-align: bottom;
line-height: 1.25; }
td { border-bottom: 1px solid var(--line); vertical-align: top; } th, td { padding: .3rem .6rem; }
td.n, th.n { text-align: right; } td.n, td:first-child { white-space: nowrap; }
td.t { color: var(--soft); background: #f6f8fa; }
.chip { font-weight: 600; white-space: nowrap; } .good { color: var(--good); } .bad { color: var(--bad); }
.half { color: var(--half); } .figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(30rem, 1fr));
gap: 1.4rem; } figure { margin: 0; } figcaption { font-size: 13px; } img { width: 100%; height: auto; }
sub { font-size: .75em; line-height: 0; }
.sum { display: flex; gap: 2.5rem; margin: 1rem 0; } .sum b { display: block; font-size: 1.6rem; }
@media (max-width: 36rem) { body { padding: 1rem; } .figures { grid-template-columns: 1fr; } }
"""

_MARKS = {
    "holds": "good",
    "partly": "half",
    "does not hold": "bad",
    "reproduced": "good",
    "differs": "half",
    CANNOT_BE_HAD: "soft",
}


@dataclass(frozen=True)
class Texts:
    """Words of a page.

    Attributes:
        title: Its heading.
        introduction: What was run and compared, in a few sentences.
        trials: Number and kind of the trials, for the head of the page: ("100", "seeds per number").
        command: The command that makes the page.
        bands: What the bounded numbers are.
        claims: Heading of the source's statements.
        figures: Key to the colours of the figures.
        remark: A further sentence on how the numbers came about.
        source: The text that the claims stand in; columns that hold this word are set apart as its own numbers.
    """

    title: str
    introduction: str
    trials: tuple[str, str]
    command: str
    bands: str
    claims: str
    figures: str
    remark: str = ""
    source: str = "thesis"


@dataclass(frozen=True)
class Report:
    """Contents of the page.

    Attributes:
        texts: Its words.
        quick: Whether only a few trials were run.
        bands, claims, sheets, drawings: The contents.
    """

    texts: Texts
    quick: bool
    bands: Sequence[Band]
    claims: Sequence[Claim]
    sheets: Sequence[Sheet]
    drawings: Sequence[Drawing]

    def write(self, folder: Path) -> None:
        """Writes ``index.html``, one CSV per table and one SVG per figure."""
        for sheet in self.sheets:
            sheet.write(folder)
        pictures = [(drawing, _svg(drawing)) for drawing in self.drawings]
        for drawing, svg in pictures:
            (folder / drawing.file).write_bytes(svg)
        (folder / "index.html").write_text(self._html(pictures), encoding="utf-8")

    def _html(self, pictures: Iterable[tuple[Drawing, bytes]]) -> str:
        texts = self.texts
        parts = [
            "<!doctype html><html lang='en'><head><meta charset='utf-8'>",
            "<meta name='viewport' content='width=device-width, initial-scale=1'>",
            f"<title>{escape(texts.title)}</title>",
            f"<style>{_STYLE}</style></head><body>",
            self._head(),
            f"<h2 id='bands'>Bands</h2><p class='soft'>{_rich(texts.bands)}</p>",
            _band_table(self.bands, self.quick),
            f"<h2 id='claims'>{escape(texts.claims)}</h2>",
            _claim_table(self.claims, texts.source),
            f"<h2 id='figures'>Figures</h2><p class='soft'>{_rich(texts.figures)}</p><div class='figures'>",
            *(_picture(drawing, svg) for drawing, svg in pictures),
            "</div><h2 id='tables'>Tables</h2>",
            *(_sheet(sheet, texts.source) for sheet in self.sheets if sheet.rows),
            "</body></html>\n",
        ]
        return "\n".join(parts)

    def _head(self) -> str:
        decided = [band for band in self.bands if not (self.quick and band.needs_all_seeds)]
        kept = sum(band.kept for band in decided)
        number_of_claims, outcome = _count([claim.verdict for claim in self.claims], self.texts.source)
        look = " This was a quick look: too few trials to judge the statistical rows." if self.quick else ""
        number, kind = self.texts.trials
        return (
            f"<h1>{escape(self.texts.title)}</h1><p>{_rich(self.texts.introduction)}</p>"
            f"<div class='sum'><div><b>{kept} of {len(decided)}</b>bands kept</div>"
            f"<div><b>{number_of_claims}</b>{escape(outcome)}</div>"
            f"<div><b>{escape(number)}</b>{escape(kind)}</div></div>"
            f"<p class='soft'>Seeds are 0, 1, 2, …: the same command gives the same numbers.{look} "
            f"{_rich(self.texts.remark)} <code>{escape(self.texts.command)}</code></p>"
            "<nav><a href='#bands'>Bands</a><a href='#claims'>Claims</a><a href='#figures'>Figures</a>"
            "<a href='#tables'>Tables</a></nav>"
        )


def _count(verdicts: Sequence[str], source: str) -> tuple[str, str]:
    """Number of the claims that hold out of all, and the words for it, in the words of the verdicts."""
    missing = verdicts.count(CANNOT_BE_HAD)
    if "reproduced" not in verdicts:
        words = f"claims of the {source} hold, {verdicts.count('partly')} partly"
        words += f", {missing} cannot be had" if missing else ""
        return f"{verdicts.count('holds')} of {len(verdicts)}", words
    differ = verdicts.count("differs")
    words = f"claims of the {source} reproduced, {differ} differ, {missing} cannot be had"
    return f"{verdicts.count('reproduced')} of {len(verdicts)}", words


def _rich(text: str) -> str:
    """Text with its indices set low: τ_1, F_x, σ_P."""
    return re.sub(r"_(\w)\b", r"<sub>\1</sub>", escape(text))


def _band_table(bands: Sequence[Band], quick: bool) -> str:
    rows = []
    for band in bands:
        shown = quick and band.needs_all_seeds
        mark, word = ("half", "shown only") if shown else ("good", "pass") if band.kept else ("bad", "FAIL")
        rows.append(
            f"<tr><td>{_rich(band.row)}</td><td>{_rich(band.name)}</td><td class='n'>{band.value:.4g}</td>"
            f"<td class='n'>{escape(band.interval)}</td><td>{escape(band.unit)}</td>"
            f"<td class='chip {mark}'>{word}</td></tr>"
        )
    head = "<tr><th>row</th><th>quantity</th><th class='n'>value</th><th class='n'>band</th><th>unit</th><th></th></tr>"
    return f"<div class='wide'><table>{head}{''.join(rows)}</table></div>"


def _claim_table(claims: Sequence[Claim], source: str) -> str:
    rows = [
        f"<tr><td>{escape(claim.source)}</td><td>{_rich(claim.statement)}</td><td>{_rich(claim.measured)}</td>"
        f"<td class='chip {_MARKS[claim.verdict]}'>{claim.verdict}</td></tr>"
        for claim in claims
    ]
    head = f"<tr><th>where</th><th>the {escape(source)}</th><th>measured</th><th>verdict</th></tr>"
    return f"<div class='wide'><table>{head}{''.join(rows)}</table></div>"


def _sheet(sheet: Sheet, source: str) -> str:
    """Columns "x" and "x ±" become one, the source's are set apart, and a group's name stands in its first row."""
    heads: list[str] = []
    kinds: list[str] = []
    bodies: list[list[str]] = []
    for name, cells in zip(sheet.columns, zip(*sheet.rows, strict=True), strict=True):
        if name.endswith(" ±"):
            bodies[-1] = [f"{a} ± {b:.2g}" for a, b in zip(bodies[-1], cells, strict=True)]
            continue
        worded = any(isinstance(cell, str) for cell in cells)
        heads.append(name)
        kinds.append("" if worded else "t n" if source in name else "n")
        bodies.append(_texts(cells))
    head = "".join(f"<th class='{kind}'>{_rich(name)}</th>" for name, kind in zip(heads, kinds, strict=True))
    if len(bodies) > 2 and kinds[:2] == ["", ""]:
        bodies[0] = ["" if k and cell == bodies[0][k - 1] else cell for k, cell in enumerate(bodies[0])]
    rows = (
        "".join(f"<td class='{kind}'>{_rich(cell)}</td>" for cell, kind in zip(row, kinds, strict=True))
        for row in zip(*bodies, strict=True)
    )
    body = "".join(f"<tr>{row}</tr>" for row in rows)
    note = f"<p class='soft'>{_rich(sheet.note)}</p>" if sheet.note else ""
    file = f"<a class='soft' href='{sheet.name}.csv'>{sheet.name}.csv</a>"
    return f"<h3>{_rich(sheet.title)} {file}</h3>{note}<div class='wide'><table><tr>{head}</tr>{body}</table></div>"


def _texts(cells: Sequence[str | float]) -> list[str]:
    """Numbers of a column with the same decimals, four digits for the largest; plainly where they differ widely."""
    sizes = [abs(cell) for cell in cells if not isinstance(cell, str) and math.isfinite(cell) and cell != 0.0]
    if not sizes or max(sizes) > 500.0 * min(sizes):
        return [cell if isinstance(cell, str) else _number(f"{cell:.4g}") for cell in cells]
    decimals = min(max(3 - math.floor(math.log10(max(sizes))), 0), 5)
    return [cell if isinstance(cell, str) else _number(f"{cell:.{decimals}f}") for cell in cells]


def _number(text: str) -> str:
    """A dash where there is no number."""
    return "–" if text == "nan" else text.replace("-", "−", 1) if text.startswith("-") else text


def _svg(drawing: Drawing) -> bytes:
    """The figure, the same bytes for the same numbers."""
    from matplotlib import rc_context

    file = io.BytesIO()
    with rc_context({"svg.hashsalt": drawing.file, "svg.fonttype": "path"}):
        drawing.figure.savefig(file, format="svg", metadata={"Date": None})
    return file.getvalue()


def _picture(drawing: Drawing, svg: bytes) -> str:
    name = "Own" if drawing.number == "own" else f"Figure {drawing.number}"
    data = base64.b64encode(svg).decode("ascii")
    title = f"{name}. {drawing.title}."
    return (
        f"<figure><img alt='{escape(title, quote=True)}' src='data:image/svg+xml;base64,{data}'>"
        f"<figcaption><b>{name}.</b> {_rich(drawing.title)}. {_rich(drawing.note)}</figcaption></figure>"
    )
