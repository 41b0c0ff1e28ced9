"""Sentences of the library in the words and the language of a page.

The library states remarks, reasons and failures in English, for its command line, and results keep them so. The
section ``sentences`` of each language file holds, by such a sentence with places {0}, {1}, … for its values, the one
that pages show. A text is recognised as a sentence with values, which may be sentences or names of parts themselves;
{0!} stands for a value that stays as it is, such as a trial's name.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from functools import cache, lru_cache
from itertools import accumulate
from typing import NamedTuple

from mbkf.viz.language import ENGLISH, contractions, decimal_sign, filled, languages, words

SECTION = "sentences"

TITLES = ("coordinates", "positive", "clinical_coordinates", "clinical_positive", "internal_moments",
          "external_moments", "joints", "measures", "units", "convention", "muscles")  # fmt: skip
"""Sections whose texts in English are recognised as well; they have no values."""

LEAST_LETTERS = 10
"""A sentence with fewer letters besides its values is recognised only if its values are known, numbers or one word."""

FEW_LETTERS = 4
"""A sentence with fewer letters is recognised only if its values are known or numbers."""

MOST_LETTERS, MOST_PARTS, MOST_NESTED = 4000, 60, 8
"""Longest text that is recognised, its separators and its brackets within brackets; one beyond stays as it is, since
recognition costs the square of its parts. Sentences of the library stay far below."""

_PLACE = re.compile(r"\{(\d)\}")
_NUMBER = re.compile(r"(?<![\w.])(\d++)\.(\d++)(?=(?:e[+-]?\d+)?(?![\w.]*\w))")
_FOLDERS = re.compile(r"""(?:^|(?<=[\s'"(]))/(?:[^\s/:;][^/:;\n]*/)+(?=[^/\s])""")
_PLAIN = re.compile(r"[\W\d_]*")
_SIZE = re.compile(r"[\W\d_]*(?:[\d.]+ \S+)?")
_IN_BRACKETS = re.compile(r"(\S+(?: …)?) \((.*)\)")
_PARTED = r"((?:(?:[,;:(]| [(…]| by | and \d).*?)?)"
_SEPARATOR = re.compile(r"; |: |\. | · ")


class Sentence(NamedTuple):
    """A recognised text.

    Attributes:
        key: The sentence, with places.
        values: Its values, in the order of the places.
    """

    key: str
    values: tuple[str, ...]


def said(text: str, language: str) -> str:
    """A text of the library in the words of a page; what is not recognised stays, with the language's decimals.

    Files are named without their folders.

    Args:
        text: A sentence, or several one after another.
        language: Code of the page's language.
    """
    if _PLAIN.fullmatch(text) or _excessive(text):
        return with_decimals(text, language)
    return _said(_FOLDERS.sub("", text), language)


def in_languages(texts: Iterable[str]) -> dict[str, dict[str, str]]:
    """The words of pages for texts, in each language by the text; without those that stay as they are.

    Args:
        texts: Sentences or names of the library.
    """
    every = list(dict.fromkeys(texts))
    return {code: {one: own for one in every if (own := said(one, code)) != one} for code in languages()}


def recognised(text: str) -> Sentence | None:
    """The sentence that a text is, with its values; None where it is not known as a whole."""
    return None if _excessive(text) else _recognised(text)


def _excessive(text: str) -> bool:
    """True for a text that no sentence of the library comes near, such as one of a damaged file."""
    if len(text) > MOST_LETTERS or sum(1 for _ in _SEPARATOR.finditer(text)) > MOST_PARTS:
        return True
    return max(accumulate((one == "(") - (one == ")") for one in text), default=0) > MOST_NESTED


def with_decimals(text: str, language: str) -> str:
    """A text with the decimal sign of a language; versions and file names keep their points."""
    sign = decimal_sign(language)
    return text if sign == "." else _NUMBER.sub(rf"\1{sign}\2", text)


@lru_cache(maxsize=8192)
def _said(text: str, language: str) -> str:
    found, (pieces, marks) = _recognised(text), _pieces(text)
    if found is not None and (all(_known(one) for one in found.values) or not _pieces_known(pieces, marks)):
        return _filled(found, language)
    if text.endswith(".") and not text.endswith(".."):
        return _said(text[:-1], language) + "."
    if text[:1].isupper() and _recognised(_lowered(text)) is not None:
        made = _said(_lowered(text), language)
        return made[:1].upper() + made[1:]
    if len(pieces) == 1 or _is_list(text):
        return _listed(text, language)
    runs = (
        (_joined(pieces, marks, first, end), [*marks, ""][end - 1]) for first, end in _runs(pieces, marks)
    )
    return "".join(_said(one, language) + mark for one, mark in runs)


def _runs(pieces: list[str], marks: list[str]) -> list[tuple[int, int]]:
    """First piece and end of each run of pieces: the longest that is a sentence but not the whole, or one piece."""
    found: list[tuple[int, int]] = []
    while not found or found[-1][1] < len(pieces):
        first = found[-1][1] if found else 0
        ends = range(len(pieces) - (first == 0), first, -1)
        known = (end for end in ends if _recognised(_joined(pieces, marks, first, end)) is not None)
        found.append((first, next(known, first + 1)))
    return found


def _pieces_known(pieces: list[str], marks: list[str]) -> bool:
    """True for several pieces of which all but the first are sentences; that one may be the name of a file."""
    runs = (
        [_joined(pieces, marks, first, end) for first, end in _runs(pieces, marks)] if len(pieces) > 1 else []
    )
    return len(runs) > 1 and all(_recognised(one) is not None for one in runs[1:])


def _lowered(text: str) -> str:
    return text[:1].lower() + text[1:]


def _filled(found: Sentence, language: str) -> str:
    own = _texts(language).get(found.key, found.key)
    made = filled(own, *(_value(one, language) for one in found.values))
    for k, value in enumerate(found.values):
        made = made.replace(f"{{{k}!}}", value)
    return contracted(made, language)


def contracted(text: str, language: str) -> str:
    """A text with the contractions of a language, e.g. "de el" as "del"."""
    for apart, together in contractions(language).items():
        text = re.sub(rf"\b{apart}\b", together, text)
    return text


def _value(text: str, language: str) -> str:
    own = text.lstrip(" ;:,.").rstrip(" ;:,")
    return text.replace(own, said(own, language), 1) if own else text


def _listed(text: str, language: str) -> str:
    """The members of a list of known names, or the text as it is."""
    members = _members(text)
    if (len(members) > 1 or _IN_BRACKETS.fullmatch(text)) and all(_known(one) for one in members[::2]):
        marks = [one.replace("and", _texts(language)["and"]) for one in members[1::2]]
        names = [_name(one, language) for one in members[::2]]
        return "".join(a + b for a, b in zip(names, [*marks, ""], strict=True))
    return with_decimals(text, language)


def _is_list(text: str) -> bool:
    """True for several sentences with commas between them, which may hold other separators themselves."""
    members = _members(text)[::2]
    return len(members) > 1 and all(_recognised(one) is not None for one in members)


def _members(text: str) -> list[str]:
    """The members of a list, with the commas and the "and" outside brackets between them."""
    members, start = [], 0
    for mark in re.finditer(r", | and ", text):
        if text[: mark.start()].count("(") == text[: mark.start()].count(")"):
            members += [text[start : mark.start()], mark[0]]
            start = mark.end()
    return _rejoined([*members, text[start:]])


def _rejoined(members: list[str]) -> list[str]:
    """Members and the marks between them, with a sentence that holds a comma or an "and" itself in one piece."""
    found = members[:1]
    for mark, member in zip(members[1::2], members[2::2], strict=True):
        if (joined := found[-1] + mark + member) in _texts(ENGLISH):
            found[-1] = joined
        else:
            found += [mark, member]
    return found


def _name(text: str, language: str) -> str:
    bracketed = None if _recognised(text) else _IN_BRACKETS.fullmatch(text)
    return said(text, language) if bracketed is None else f"{bracketed[1]} ({said(bracketed[2], language)})"


def _pieces(text: str) -> tuple[list[str], list[str]]:
    """Parts of a text between its separators outside brackets, and these."""
    pieces, marks, start = [], [], 0
    for mark in _SEPARATOR.finditer(text):
        before = text[: mark.start()]
        if before.count("(") == before.count(")"):
            pieces.append(text[start : mark.start()])
            marks.append(mark[0])
            start = mark.end()
    return [*pieces, text[start:]], marks


def _joined(pieces: list[str], marks: list[str], first: int, end: int) -> str:
    return pieces[first] + "".join(
        a + b for a, b in zip(marks[first : end - 1], pieces[first + 1 : end], strict=True)
    )


@lru_cache(maxsize=8192)
def _recognised(text: str) -> Sentence | None:
    known = _texts(ENGLISH)
    if text in known and not _PLACE.search(text):
        return Sentence(text, ())
    fitting = [found for fits in _patterns() if (found := fits(text)) is not None]
    whole = (one for one in fitting if all(_known(value) for value in one.values))
    return next(whole, fitting[0] if fitting else None)


@cache
def _texts(language: str) -> Mapping[str, str]:
    """The page's text in a language by the library's sentence."""
    found: dict[str, str] = {}
    for section in TITLES:
        own = words(language, section)
        found |= {text: own[name] for name, text in words(ENGLISH, section).items() if "{" not in text}
    return found | dict(words(language, SECTION))


@cache
def _patterns() -> tuple[Callable[[str], Sentence | None], ...]:
    """Recognisers of the sentences with values, the one with the most letters of its own first."""
    keys = [key for key in words(ENGLISH, SECTION) if _PLACE.search(key)]
    return tuple(_recogniser(key) for key in sorted(keys, key=lambda key: -_letters(key)))


def _recogniser(key: str) -> Callable[[str], Sentence | None]:
    parts = _PLACE.split(key)
    own, places = parts[::2], [int(k) for k in parts[1::2]]
    longest, letters = max(own, key=len), _letters(key)
    short = letters < LEAST_LETTERS
    # A value directly after another one is empty, or begins with a sign that parts them.
    groups = ["(.*?)" if before or k == 0 else _PARTED for k, before in enumerate(own[:-1])]
    pattern = re.compile(
        "".join(re.escape(one) + group for one, group in zip(own, [*groups, ""], strict=True))
    )

    def fits(text: str) -> Sentence | None:
        if longest not in text:
            return None
        found = pattern.fullmatch(text)
        if found is None:
            return None
        values = dict(zip(places, found.groups(), strict=True))
        if text in found.groups():
            return None
        ordered = tuple(values[k] for k in sorted(values))
        known = not short or all(_known(one) for one in ordered)
        sized = letters >= FEW_LETTERS or all(_SIZE.fullmatch(one) or _recognised(one) for one in ordered)
        return Sentence(key, ordered) if known and sized else None

    return fits


def _known(value: str) -> bool:
    """True for a number, one word, a known sentence, or a list of these."""
    if _recognised(value.strip(" ;:,")) is not None:
        return True
    return all(_is_name(one) or _recognised(one) is not None for one in _members(value)[::2])


def _is_name(text: str) -> bool:
    """True for a size, one word, and one word with a known text in brackets."""
    bracketed = _IN_BRACKETS.fullmatch(text)
    return bool(_SIZE.fullmatch(text)) or " " not in text or (bracketed is not None and _known(bracketed[2]))


def _letters(key: str) -> int:
    return sum(letter.isalpha() for letter in _PLACE.sub("", key))
