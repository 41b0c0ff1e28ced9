"""The part of a session's report on scores: Gait Profile Score, Movement Analysis Profile, gait deviation index."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape

from mbkf.io.norms import Band, Norms
from mbkf.study.session.means import Mean, half_width
from mbkf.study.session.records import MovementGroup
from mbkf.study.session.scores import GPS, GaitScores, gait_scores
from mbkf.viz.markup import paragraph, table
from mbkf.viz.session.profile_chart import ProfileRow, profile_chart
from mbkf.viz.session.terms import Terms
from mbkf.viz.svg import number

GDI = "GDI"

LEAST_CYCLES = 3
"""Sides with fewer cycles have no interval: with one degree of freedom it is wide or narrow by chance."""


@dataclass(frozen=True)
class ScoreLine:
    """A row of the table: a score of right, left and both, and of the norms' own persons."""

    title: str
    right: Mean | None
    left: Mean | None
    both: Mean | None = None
    norm: Band | None = None


def scores_part(gait: MovementGroup, norms: Norms | None, terms: Terms) -> str:
    """Heading, profile and table; an empty text without norms that have angles of this kind of gait.

    Args:
        gait: The gait.
        norms: The laboratory's; None without.
        terms: The report's words.
    """
    scores = None if norms is None else gait_scores(gait, norms)
    if norms is None or scores is None:
        return ""
    lines = _lines(gait, scores, norms, terms)
    rows = [
        (
            f"{one.title}, {terms.unit('deg')}",
            _text(one.right),
            _text(one.left),
            _text(one.both),
            _norm(one.norm),
        )
        for one in lines
    ]
    right, left = _gdi(scores)
    if right is not None or left is not None:
        rows.append((terms.score(GDI), _text(right), _text(left), "–", "100 ± 10"))
    note = terms.say("scores_note", norms.name)
    if scores.lacking:
        note += " " + terms.say("scores_lacking", ", ".join(terms.score(name) for name in scores.lacking))
    if any(mean is not None and mean.count < LEAST_CYCLES for mean in (*_gps(scores), scores.gps)):
        note += " " + terms.say("scores_few", LEAST_CYCLES)
    heads = ["", *(terms.say(word) for word in ("right", "left", "both", "norm"))]
    return "".join(
        (
            f"<h3>{escape(terms.say('scores'))}</h3>",
            paragraph(note),
            _profile(lines, terms),
            table(heads, rows),
        )
    )


def scores_of_sheet(gait: MovementGroup, norms: Norms | None, terms: Terms) -> str:
    """GPS and GDI in a line, and the profile; an empty text without norms that have angles of this kind of gait.

    Args:
        gait: The gait.
        norms: The laboratory's; None without.
        terms: The report's words.
    """
    scores = None if norms is None else gait_scores(gait, norms)
    if norms is None or scores is None:
        return ""
    lines = _lines(gait, scores, norms, terms)
    right, left = _gdi(scores)
    total = lines[-1]
    texts = [
        terms.sheet("gps", *(_text(one) for one in (total.both, total.right, total.left)), _norm(total.norm))
    ]
    if right is not None or left is not None:
        texts.append(terms.sheet("gdi", _text(right), _text(left)))
    if scores.lacking:
        texts.append(terms.say("scores_lacking", ", ".join(terms.score(name) for name in scores.lacking)))
    return "".join(
        (
            f"<h4>{escape(terms.say('scores'))}</h4>",
            f'<p class="gait-line">{escape(" ".join(texts))}</p>',
            _profile(lines, terms),
            paragraph(terms.sheet("scores_note", norms.name)),
        )
    )


def _profile(lines: list[ScoreLine], terms: Terms) -> str:
    drawn = [ProfileRow(one.title, _pair(one.right), _pair(one.left), _band(one.norm)) for one in lines]
    return profile_chart(terms.say("profile"), drawn, terms.unit("deg"))


def _lines(gait: MovementGroup, scores: GaitScores, norms: Norms, terms: Terms) -> list[ScoreLine]:
    """A line for each variable, and one for the GPS."""
    right, left = scores.sides
    names = list(next(side.gvs for side in scores.sides if side is not None))

    def norm(name: str) -> Band | None:
        return norms.measures.get((gait.kind.value, name))

    lines = [
        ScoreLine(
            terms.score(name),
            None if right is None else right.gvs[name],
            None if left is None else left.gvs[name],
            norm=norm(name),
        )
        for name in names
    ]
    return [*lines, ScoreLine(terms.score(GPS), *_gps(scores), scores.gps, norm(GPS))]


def _gps(scores: GaitScores) -> tuple[Mean | None, Mean | None]:
    """The score of right and left."""
    right, left = scores.sides
    return None if right is None else right.gps, None if left is None else left.gps


def _gdi(scores: GaitScores) -> tuple[Mean | None, Mean | None]:
    """The Gait Deviation Index of right and left."""
    right, left = scores.sides
    return None if right is None else right.gdi, None if left is None else left.gdi


def _pair(mean: Mean | None) -> tuple[float, float] | None:
    """A score with half of its interval, 0 of too few cycles."""
    if mean is None:
        return None
    return float(mean.mean[0]), float(half_width(mean)[0]) if mean.count >= LEAST_CYCLES else 0.0


def _band(norm: Band | None) -> tuple[float, float] | None:
    return None if norm is None else (float(norm.mean[0]), float(norm.sd[0]))


def _text(mean: Mean | None) -> str:
    pair = _pair(mean)
    if mean is None or pair is None:
        return "–"
    return _plus_minus(*pair) if mean.count >= LEAST_CYCLES else number(pair[0], 1)


def _norm(norm: Band | None) -> str:
    band = _band(norm)
    return "–" if band is None else _plus_minus(*band)


def _plus_minus(value: float, spread: float) -> str:
    return f"{number(value, 1)} ± {number(spread, 1)}"
