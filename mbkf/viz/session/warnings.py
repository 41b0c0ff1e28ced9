"""Verdict and warnings of a whole session in few lines, for the sheet; each reason stands once, with its trials."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from html import escape

from mbkf.io.verdict import WORDS, Word, gravest
from mbkf.study.session.records import Session, SessionTrial
from mbkf.viz.report.verdict import KINDS
from mbkf.viz.sentences import said
from mbkf.viz.session.terms import Terms

LETTERS_PER_LINE = 105
"""Letters that a printed line of the sheet holds, cautiously."""


def warnings_box(session: Session, terms: Terms, lines: int) -> str:
    """The gravest word, how many trials have which, and the reasons in so many lines.

    Args:
        session: The session.
        terms: The report's words.
        lines: Lines for reasons; those beyond are counted, and stand with the trials.
    """
    found = list(_reasons(session, terms))
    kept = fitting([text for text, _ in found], lines)
    items = "".join(f'<li class="{KINDS[word]}">{escape(text)}</li>' for text, word in found[:kept])
    left = len(found) - kept
    more = f'<p class="more">{escape(terms.sheet("more_remarks", left))}</p>' if left else ""
    counts = Counter(trial.verdict for trial in session.trials)
    words_of = ", ".join(f"{counts[word]} {_word(word, terms)}" for word in WORDS if counts[word])
    worst = session_word(session)
    line = terms.sheet(worst.replace(" ", "_"))
    return (
        f'<div class="verdict {KINDS[worst]}"><p class="line">{escape(line)}</p>'
        f'<p class="parts">{escape(terms.sheet("trials_with", words_of))}</p>'
        f"{f'<ul>{items}</ul>' if items else ''}{more}</div>"
    )


def session_word(session: Session) -> Word:
    """The gravest word on its trials, and on trials that disagree with the others."""
    return gravest(
        [*(_known(one.verdict) for one in session.trials), *(d.word for d in session.disagreements)]
    )


def fitting(texts: Iterable[str], lines: int) -> int:
    """The number of texts, from the first on, that fit into so many lines."""
    used = kept = 0
    for text in texts:
        used += -(-len(text) // LETTERS_PER_LINE)
        if used > lines:
            break
        kept += 1
    return kept


def _reasons(session: Session, terms: Terms) -> Iterable[tuple[str, Word]]:
    """Reasons and remarks, of the gravest trials first; trials of the same one stand together."""
    for one in session.disagreements:
        yield said(one.sentence, terms.language), one.word
    together: dict[str, list[SessionTrial]] = {}
    for trial in sorted(session.trials, key=lambda one: -WORDS.index(_known(one.verdict))):
        for remark in dict.fromkeys(trial.remarks):
            together.setdefault(remark, []).append(trial)
    for remark, trials in together.items():
        everywhere = len(trials) == len(session.trials) > 1
        who = terms.sheet("all_trials") if everywhere else ", ".join(trial.name for trial in trials)
        yield f"{who}: {said(remark, terms.language)}", gravest([_known(trial.verdict) for trial in trials])


def _known(word: str) -> Word:
    return next(one for one in WORDS if one == word)


def _word(word: str, terms: Terms) -> str:
    return terms.say(word.replace(" ", "_"))
