"""Sides in the name of a marker, in front, behind or inside, and the rest of the name without them."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass

PAIRS = (
    ("right", "left"), ("r", "l"), ("rt", "lt"), ("rgt", "lft"), ("rx", "lx"), ("re", "li"),
    ("rechts", "links"), ("rechte", "linke"), ("rechter", "linker"), ("rechtes", "linkes"),
    ("droite", "gauche"), ("droit", "gauche"), ("dx", "sx"), ("destra", "sinistra"), ("destro", "sinistro"),
    ("derecha", "izquierda"), ("derecho", "izquierdo"), ("der", "izq"),
    ("direita", "esquerda"), ("direito", "esquerdo"),
)  # fmt: skip
"""Words for right and left, by pairs, in English, German, French, Italian, Spanish and Portuguese."""

INITIALS = (("d", "g"), ("d", "s"), ("d", "i"), ("d", "e"))
"""Initials of the same words: used only where the set also holds the marker of the other side."""

WEIGHTS = {
    "word": 1.0, "token": 0.95, "inner token": 0.8, "first letter": 0.7, "last letter": 0.35, "inner letter": 0.1,
    "initial": 0.3, "none": 0.5,
}  # fmt: skip
"""Prior weight of each way to state a side, before the other names of the set are considered."""

NEEDS_PARTNER = ("initial", "inner letter", "last letter")
"""Ways that count only where the set holds the marker of the other side, or states many sides this way."""

APART = ("word", "token", "inner token")
"""Ways with a separate word or letter, which is hardly part of the place's name."""

_TOKEN = re.compile(r"(?<![A-Za-z])[A-Za-z]\d+|[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+|\d+")
_LETTERS = {"r": ("right", "l"), "l": ("left", "r")}
_SHORTEST_WORD = 4


@dataclass(frozen=True)
class SideGuess:
    """One way to read the side out of a name.

    Attributes:
        side: "right", "left", or "" for a name without a side.
        rest: The name without its side, in small letters and digits.
        style: The way the side is stated, a key of :data:`WEIGHTS`.
        partner: The name of the other side's marker in the same letters, "" without a side.
    """

    side: str
    rest: str
    style: str
    partner: str


def tokens_of(name: str) -> list[str]:
    """Words of a name in small letters, cut at separators, at capitals and between letters and digits."""
    plain = unicodedata.normalize("NFKD", name.replace("ß", "ss"))
    return [token.lower() for token in _TOKEN.findall("".join(c for c in plain if ord(c) < 128))]


def side_words() -> frozenset[str]:
    """Every word and initial that may state a side."""
    return frozenset(word for pair in (*PAIRS, *INITIALS) for word in pair)


def side_guesses(name: str) -> list[SideGuess]:
    """Every way to read a side out of a name; the last is without a side."""
    tokens = tokens_of(name)
    text = "".join(tokens)
    found: dict[tuple[str, str], SideGuess] = {}
    for guess in (*_tokens(tokens), *_letters(text), SideGuess("", text, "none", "")):
        if guess.rest:
            found.setdefault((guess.side, guess.rest), guess)
    return list(found.values())


def _tokens(tokens: list[str]) -> Iterator[SideGuess]:
    """Sides stated by a separate word or letter."""
    for pairs, initial in ((PAIRS, False), (INITIALS, True)):
        for at, token in enumerate(tokens):
            for pair in pairs:
                if token not in pair:
                    continue
                side, other = ("right", pair[1]) if token == pair[0] else ("left", pair[0])
                ends = at in (0, len(tokens) - 1)
                style = "token" if ends else "inner token"
                if len(token) >= _SHORTEST_WORD:
                    style = "word"
                yield SideGuess(
                    side,
                    "".join(tokens[:at] + tokens[at + 1 :]),
                    "initial" if initial else style,
                    "".join([*tokens[:at], other, *tokens[at + 1 :]]),
                )


def _letters(text: str) -> Iterator[SideGuess]:
    """Sides stated by a word at an end of the name, or by a letter anywhere in it."""
    for right, left in PAIRS:
        for side, word, other in (("right", right, left), ("left", left, right)):
            if len(word) >= _SHORTEST_WORD and text.startswith(word):
                rest = text.removeprefix(word)
                yield SideGuess(side, rest, "word", other + rest)
            if len(word) >= _SHORTEST_WORD and text.endswith(word):
                rest = text.removesuffix(word)
                yield SideGuess(side, rest, "word", rest + other)
    order = [0, len(text) - 1, *range(1, len(text) - 1)] if len(text) > 1 else []
    for at in order:
        if text[at] in _LETTERS:
            side, other = _LETTERS[text[at]]
            style = "first letter" if at == 0 else "last letter" if at == len(text) - 1 else "inner letter"
            before, after = text[:at], text[at + 1 :]
            yield SideGuess(side, before + after, style, before + other + after)
