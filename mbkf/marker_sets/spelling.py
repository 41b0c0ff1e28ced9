"""The dictionary of marker spellings: from a name without its side to places of the body, by a small grammar.

A name is read as one place ("knee", "lfc") with modifiers around it ("lateral", "upper", a number, another part of
the body as in "femoral epicondyle"). Its pieces must cover it: a name with an unknown piece remains unread.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from mbkf.conventions import TomlTable, data_folder
from mbkf.errors import FileFormatError
from mbkf.io.plain_data import read_toml

Odds = Mapping[str, float]
"""Probability by place: a landmark or segment of human18 without its side."""

SURE = 0.95
"""Probability of a place that the file gives without one."""
SILENT = ("filler",)
"""Modifiers without a meaning."""
_LETTERS = "apdulmfbstic"
_LEADING_LETTERS = "pda"
_MOST_LETTERS = 2
_MOST_PIECES, _MOST_PLACES = 6, 2
_MIDLINE_WITH_SIDE = 0.6
_NUMBERED = frozenset(("number", "letter"))
_SHORTEST_PAIR = 6
_DIGITS = re.compile(r"\d+")


@dataclass(frozen=True)
class Company:
    """Places that a spelling means beside certain others of the same set.

    Attributes:
        any: Spellings of which the set must hold one.
        places: Places of names without a side, None for the usual ones.
        sided: Places of names with a side, None for the usual ones.
    """

    any: frozenset[str]
    places: Odds | None
    sided: Odds | None


@dataclass(frozen=True)
class Group:
    """Spellings of one meaning; markers/dictionary/spellings.toml explains the fields."""

    spellings: tuple[str, ...]
    places: Odds
    sided: Odds | None = None
    modified: Mapping[frozenset[str], Odds] = field(default_factory=dict)
    modifiable: bool = True
    region: str = ""
    keypoint: str = ""
    signature: bool = False
    kind: str = "marker"
    middle: bool = False
    cluster: bool = False
    beside: tuple[Company, ...] = ()


@dataclass(frozen=True)
class Parse:
    """A name without its side as the grammar takes it apart.

    Attributes:
        group: Its meaning.
        spelling: The spelling of the place.
        modifiers: Names of the modifiers around it.
        quality: Plainness of the spelling, 0 to 1: single letters of direction reduce it.
    """

    group: Group
    spelling: str
    modifiers: frozenset[str]
    quality: float

    def places(self, sided: bool, company: frozenset[str]) -> tuple[Odds, bool]:
        """Probability by place; and False where a modifier moves the marker away from the landmark, to its segment.

        ``sided`` is True for a name with a side, ``company`` are the spellings of the other names of the set.
        """
        group = self.group
        keys = [key for key in group.modified if key <= self.modifiers]
        if group.cluster and self.modifiers & _NUMBERED:
            keys = [key for key in keys if key & _NUMBERED]
        if keys:
            return group.modified[max(keys, key=lambda key: (len(key), sorted(key)))], True
        places = group.sided if sided and group.sided is not None else group.places
        for one in group.beside:
            if one.any & company:
                other = one.sided if sided and one.sided is not None else one.places
                if other is not None:
                    places = other
                    break
        if sided and group.middle and group.sided is None:
            places = {place: _MIDLINE_WITH_SIDE * odds for place, odds in places.items()}
        return places, not self.modifiers.difference(SILENT)


@dataclass(frozen=True)
class _Piece:
    """A meaning of a word of the dictionary."""

    kind: str
    value: str = ""
    group: Group | None = None


@dataclass(frozen=True)
class _Used:
    """Numbers of pieces, places and letters of direction in the read part of a name."""

    pieces: int = 0
    places: int = 0
    letters: int = 0

    def and_one(self, places: bool = False, letters: bool = False) -> _Used:
        return _Used(self.pieces + 1, self.places + places, self.letters + letters)


class Spellings:
    """The dictionary: words of the names of markers and the grammar that joins them."""

    def __init__(self, groups: Iterable[Group], modifiers: Mapping[str, Iterable[str]]) -> None:
        """Takes the groups of places and, by modifier, the words for it."""
        self._words: dict[str, list[_Piece]] = {}
        self.places: dict[str, Group] = {}
        for group in groups:
            for spelling in group.spellings:
                self.places[spelling] = group
                self._words.setdefault(spelling, []).append(_Piece("place", spelling, group))
        for modifier, words in modifiers.items():
            for word in words:
                self._words.setdefault(word, []).append(_Piece("modifier", modifier))
        self._longest = max(map(len, self._words))
        self._known: dict[str, Parse | None] = {}

    def knows(self, word: str) -> bool:
        """True where a word is a place or modifier of the dictionary."""
        return word in self._words or bool(_DIGITS.fullmatch(word)) or self.parse(word) is not None

    def parse(self, text: str) -> Parse | None:
        """The plainest way to read a name without its side, None without a complete reading."""
        if text not in self._known:
            self._known[text] = self._parse(text)
        return self._known[text]

    def _parse(self, text: str) -> Parse | None:
        if text in self.places:
            return Parse(self.places[text], text, frozenset(), 1.0)
        best: tuple[float, Parse] | None = None
        for pieces in self._covers(text, 0, _Used()):
            parse = _joined(pieces)
            score = sum(len(word) ** 2 for word, _ in pieces)
            if parse is not None and (best is None or score > best[0]):
                best = (score, parse)
        return best[1] if best else None

    def _covers(self, text: str, at: int, used: _Used) -> list[list[tuple[str, _Piece]]]:
        """Every way to cover the text from a position on with a few known words, among them one or two places."""
        if at == len(text):
            return [[]] if used.places else []
        if used.pieces == _MOST_PIECES:
            return []
        nexts: list[tuple[str, _Piece, _Used]] = []
        for end in range(min(len(text), at + self._longest), at, -1):
            word = text[at:end]
            for piece in self._words.get(word, ()):
                nexts.append((word, piece, used.and_one(places=piece.kind == "place")))
        if match := _DIGITS.match(text, at):
            nexts.append((match.group(), _Piece("modifier", "number"), used.and_one()))
        leading = at == 0 and text[at] in _LEADING_LETTERS
        if (used.places or leading) and text[at] in _LETTERS:
            nexts.append((text[at], _Piece("letter"), used.and_one(letters=True)))
        return [
            [(word, piece), *tail]
            for word, piece, then in nexts
            if then.places <= _MOST_PLACES and then.letters <= _MOST_LETTERS
            for tail in self._covers(text, at + len(word), then)
        ]


def _joined(pieces: list[tuple[str, _Piece]]) -> Parse | None:
    """One place with modifiers out of the pieces of a name, None where they do not combine."""
    places = [piece for _, piece in pieces if piece.group is not None]
    head, modifiers, quality = places[-1], set(), 0.98
    if len(places) == 2:
        regions = [piece for piece in places if piece.group is not None and piece.group.region]
        if places[0].group is places[1].group:
            head = places[0]
        elif sum(len(piece.value) for piece in places) < _SHORTEST_PAIR:
            return None
        elif len(regions) == 1:
            head = next(piece for piece in places if piece is not regions[0])
            modifiers.add(regions[0].group.region if regions[0].group else "")
        else:
            return None
    group = head.group
    if group is None:
        return None
    for word, piece in pieces:
        if piece.kind == "letter":
            if not group.cluster:
                return None
            modifiers.add("letter")
            quality = 0.95
        elif piece.kind == "modifier":
            if len(word) == 1 and piece.value in ("lateral", "medial"):
                # "l" and "m" beside a place are lateral and medial only where it has both sides ("knem").
                if group.cluster or frozenset((piece.value,)) not in group.modified or len(head.value) < 2:
                    return None
                quality = 0.94
            modifiers.add(piece.value)
    if not group.modifiable and modifiers - {"filler", "made", "number", "middle"}:
        return None
    if {"lateral", "medial"} <= modifiers:
        return None
    return Parse(group, head.value, frozenset(modifiers), quality)


@dataclass(frozen=True)
class Dictionary:
    """The contents of markers/dictionary/spellings.toml.

    Attributes:
        spellings: Places and the grammar of their names.
        objects: Words of things off the body.
        lone_objects: Words of such things, unless the name also holds a place of the body.
        computed: Words of software's outputs.
        computed_within: Texts within the names of such outputs.
        computed_ends: Ends of the names of such outputs.
    """

    spellings: Spellings
    objects: frozenset[str]
    lone_objects: frozenset[str]
    computed: frozenset[str]
    computed_within: tuple[str, ...] = ()
    computed_ends: tuple[str, ...] = ()


@cache
def load_dictionary(path: Path | None = None) -> Dictionary:
    """Reads the dictionary of spellings, by default the one that comes with the package.

    Raises:
        FileFormatError: The file is not a valid dictionary, or spells two groups the same.
    """
    path = path or data_folder("markers") / "dictionary" / "spellings.toml"
    try:
        table = read_toml(path)
        groups = [_group(entry) for entry in table["place"]]
        modifiers, objects = table["modifiers"], table["objects"]
        software = table["computed"]
        computed = frozenset(software["words"])
        within, ends = tuple(software.get("within", ())), tuple(software.get("ends", ()))
    except OSError as error:
        raise FileFormatError(path, f"cannot be read ({error.strerror})") from error
    except (KeyError, TypeError, ValueError) as error:
        raise FileFormatError(path, f"not a valid dictionary of spellings: {error}") from error
    seen: set[str] = set()
    for group in groups:
        for spelling in group.spellings:
            if spelling in seen:
                raise FileFormatError(path, f"'{spelling}' is in two groups; keep it in one")
            seen.add(spelling)
    return Dictionary(
        Spellings(groups, modifiers),
        frozenset(objects["always"]),
        frozenset(objects["alone"]),
        computed,
        within,
        ends,
    )


def _group(entry: TomlTable) -> Group:
    return Group(
        spellings=tuple(entry["spellings"]),
        places=_odds(entry["places"]),
        sided=_odds(entry["sided"]) if "sided" in entry else None,
        modified={frozenset(key.split()): _odds(odds) for key, odds in entry.get("modified", {}).items()},
        modifiable=bool(entry.get("modifiable", True)),
        region=str(entry.get("region", "")),
        keypoint=str(entry.get("keypoint", "")),
        signature=bool(entry.get("signature", False)),
        kind=str(entry.get("kind", "marker")),
        middle=bool(entry.get("middle", False)),
        cluster=bool(entry.get("cluster", False)),
        beside=tuple(
            Company(
                frozenset(one["any"]),
                _odds(one["places"]) if "places" in one else None,
                _odds(one["sided"]) if "sided" in one else None,
            )
            for one in entry.get("beside", ())
        ),
    )


def _odds(value: str | TomlTable) -> Odds:
    """Probability by place, from a table or from the name of a nearly certain place."""
    odds = {value: SURE} if isinstance(value, str) else {str(k): float(p) for k, p in value.items()}
    if any(not 0 < p <= 1 for p in odds.values()) or sum(odds.values()) > 1 + 1e-9:
        raise ValueError(f"probabilities of {sorted(odds)} must lie between 0 and 1 and add up to 1 at most")
    return odds
