"""Places of markers by their names alone, from a dictionary of spellings and a small grammar.

All names of a capture are read together, because a set shares a convention. Affixes that many of them share are removed
(:mod:`mbkf.marker_sets.affixes`); each way to find a side in a name is tried (:mod:`mbkf.marker_sets.sides`); the rest
is looked up (:mod:`mbkf.marker_sets.spelling`). A way counts more where the set holds the marker of the other side
(RKNE, LKNE) and where the other names state their side in the same way; an L counts as "lateral" where the set holds
the same name with an M. A name that can be read in several ways keeps them with their probabilities; a name with an
unknown piece remains unread.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from mbkf.marker_sets.affixes import Core, without_affixes
from mbkf.marker_sets.sides import (
    APART,
    NEEDS_PARTNER,
    WEIGHTS,
    SideGuess,
    side_guesses,
    side_words,
    tokens_of,
)
from mbkf.marker_sets.spelling import Dictionary, Odds, Parse, load_dictionary
from mbkf.model.body_file import load_body

KINDS = ("marker", "keypoint", "computed", "object", "unknown")
"""Kinds of named points: on the skin; a joint's centre of a markerless system; made by software; off the body."""

BODY = "human18"
"""The body of the places' segments and landmarks."""

_WITH_PARTNER, _WITHOUT_PARTNER = 6.0, 0.4
_PARTNER_ELSEWHERE, _SIDE_POSSIBLE, _WHOLE_WORD = 0.15, 0.3, 0.3
_UNCONVENTIONAL, _CONVENTION = 0.15, 0.3
_LEAST = 0.02
_MOSTLY = 0.8
_SPINE = {"c": 7, "t": 12, "l": 5, "s": 5}
_AXES = ("o", "a", "l", "p")
_NUMBERED = re.compile(r"([a-z])(\d+)")
_SHORTEST_OBJECT = 3


@dataclass(frozen=True)
class NamedPlace:
    """A place on the body that a name may mean.

    Attributes:
        segment: Segment of human18.
        landmark: Landmark of human18, "" where the name means the segment only.
        probability: Probability of this place.
    """

    segment: str
    landmark: str
    probability: float


@dataclass(frozen=True)
class NameReading:
    """The reading of one point's name.

    Attributes:
        name: The name as given.
        places: Likeliest first; their probabilities add up to 1 at most. Empty for a name without a place.
        kind: One of :data:`KINDS`.
        side: "right", "left", "middle", or "" where it is unknown.
    """

    name: str
    places: tuple[NamedPlace, ...]
    kind: str
    side: str


@dataclass(frozen=True)
class _Way:
    """One way to read a name: a side and a place."""

    guess: SideGuess
    parse: Parse
    weight: float


def read_names(names: Sequence[str]) -> dict[str, NameReading]:
    """Reads the names of all points of one capture together.

    Args:
        names: The names as the file has them.

    Returns:
        The reading by name; unread names are of kind "unknown" without places.
    """
    dictionary = load_dictionary()
    sides = side_words()
    sets: dict[tuple[str, ...], list[Core]] = defaultdict(list)
    for core in without_affixes(
        list(dict.fromkeys(names)),
        lambda word: word.lower() in sides or any(map(dictionary.spellings.knows, _texts_of(word))),
    ):
        sets[core.affixes].append(core)
    readings = {
        reading.name: reading for cores in sets.values() for reading in _Set(cores, dictionary).readings()
    }
    return {name: readings[name] for name in names}


def _texts_of(word: str) -> list[str]:
    """A word as a name, and its rests without a side."""
    return [guess.rest for guess in side_guesses(word)]


class _Set:
    """The names of one set, read together."""

    def __init__(self, cores: Sequence[Core], dictionary: Dictionary) -> None:
        self.cores, self.dictionary = cores, dictionary
        self.texts = {"".join(tokens_of(core.core)) for core in cores}
        first = {core.name: self._ways(core, {}) for core in cores}
        styles = self._styles(first)
        self.ways = {core.name: self._ways(core, styles) for core in cores}
        best = [ways[0].parse for ways in self.ways.values() if ways]
        self.company = frozenset(parse.spelling for parse in best)
        pointlike = [parse for parse in best if parse.group.keypoint]
        self.keypoints = len(pointlike) >= _MOSTLY * len(best) and any(
            parse.group.signature for parse in pointlike
        )

    def readings(self) -> list[NameReading]:
        """The reading of each name."""
        return [self._reading(core) for core in self.cores]

    def _ways(self, core: Core, styles: Mapping[str, float]) -> list[_Way]:
        """Every way to read a name, likeliest first.

        Args:
            core: The name.
            styles: Share of the set's names that state their side in each style; empty where unknown.
        """
        guesses = side_guesses(self._text(core))
        parses = {guess: self.dictionary.spellings.parse(guess.rest) for guess in guesses}
        # Where the other side's marker exists, the letter is its side, even if the rest is unknown.
        stated = any(guess.partner in self.texts and parse is None for guess, parse in parses.items())
        ways = []
        for guess, parse in parses.items():
            if parse is None or not (guess.partner in self.texts or _counts_alone(guess, styles)):
                continue
            if not guess.side and (stated or self._is_a_number(guess.rest)):
                continue
            places, _ = parse.places(bool(guess.side), frozenset())
            weight = WEIGHTS[guess.style] * parse.quality * sum(places.values())
            if guess.side:
                weight *= self._trust(guess, styles)
            if weight > 0:
                ways.append(_Way(guess, parse, weight))
        return sorted(self._doubted(ways), key=lambda way: -way.weight)

    def _trust(self, guess: SideGuess, styles: Mapping[str, float]) -> float:
        """Weight that the other names of the set give a side."""
        if len(self.texts) == 1:
            return 1.0
        trust = _WITH_PARTNER if guess.partner in self.texts else _WITHOUT_PARTNER
        return trust * (_UNCONVENTIONAL + styles.get(guess.style, 0.0)) if styles else trust

    def _doubted(self, ways: Sequence[_Way]) -> list[_Way]:
        """Ways of a name, weighed down where ways with and without a side contradict each other."""
        sided = [way for way in ways if way.guess.side]
        plain = [way for way in ways if not way.guess.side]
        if not sided or not plain:
            return list(ways)
        against_plain, against_sided = _SIDE_POSSIBLE, 1.0
        apart = any(way.guess.style in APART for way in sided)
        if any(way.guess.partner in self.texts for way in sided):
            against_plain = _PARTNER_ELSEWHERE * (_PARTNER_ELSEWHERE if apart else 1.0)
        elif any(self._is_lateral(way.guess) for way in sided):
            against_plain = _WITH_PARTNER
        elif apart:
            against_plain = _SIDE_POSSIBLE * _PARTNER_ELSEWHERE
        elif plain[0].parse.quality == 1.0:
            against_plain, against_sided = 1.0, _WHOLE_WORD
        return [
            replace(way, weight=way.weight * (against_sided if way.guess.side else against_plain))
            for way in ways
        ]

    def _is_lateral(self, guess: SideGuess) -> bool:
        """True where an L taken for left may be "lateral": the set holds the same name with an M."""
        medial = {f"r{guess.rest}": f"m{guess.rest}", f"{guess.rest}r": f"{guess.rest}m"}
        return guess.side == "left" and medial.get(guess.partner, "") in self.texts

    def _styles(self, ways: dict[str, list[_Way]]) -> dict[str, float]:
        """Share of the names with a partner that state their side in each style."""
        counts = Counter(
            found[0].guess.style for found in ways.values() if found and found[0].guess.partner in self.texts
        )
        return {style: count / counts.total() for style, count in counts.items()}

    def _is_a_number(self, text: str) -> bool:
        """True for a letter and a number that are a place in a row, not a vertebra: S1 ... S20, L4 beside R4."""
        match = _NUMBERED.fullmatch(text)
        if match is None or match.group(1) not in _SPINE:
            return False
        letter, digits = match.groups()
        if letter == "l" and f"r{digits}" in self.texts:
            return True
        found = [m.groups() for m in map(_NUMBERED.fullmatch, self.texts) if m and m.group(1) in _SPINE]
        row = {number for other, number in found if other == letter}
        others = {other for other, _ in found if other != letter}
        beyond = any(n.startswith("0") or int(n) > _SPINE[letter] for n in row)
        return beyond or (not others and {"1", "2", "3"} <= row)

    def _is_axis(self, text: str) -> bool:
        """True for a point of a segment's axes, stored as four points O, A, L and P: LTIO, LTIA, LTIL, LTIP."""
        return text[-1:] in _AXES and all(text[:-1] + end in self.texts for end in _AXES)

    def _is_output(self, text: str) -> bool:
        """True for the name of a software's output that no place explains: AXIS1, LKneeMoment, RHJC2."""
        dictionary = self.dictionary
        return any(part in text for part in dictionary.computed_within) or re.sub(r"\d+$", "", text).endswith(
            dictionary.computed_ends
        )

    def _virtual(self, core: Core) -> bool:
        """True for the name of another marker with a "v", its virtual twin."""
        text = "".join(tokens_of(core.core))
        return len(text) > 2 and text.endswith("v") and text[:-1] in self.texts

    def _frame(self, core: Core) -> str:
        """The name of a segment's frame that is stored as its origin and the tips of two axes: LUAR, LUARY, LUARZ."""
        text = "".join(tokens_of(core.core))
        stem = text[:-1] if text[:-1] in self.texts and text.endswith(("y", "z")) else text
        return stem if len(stem) > 2 and {f"{stem}y", f"{stem}z"} <= self.texts else ""

    def _text(self, core: Core) -> str:
        """The name, without the sign of a virtual twin or of an axis."""
        if self._virtual(core):
            return "".join(tokens_of(core.core))[:-1]
        return self._frame(core) or core.core

    def _reading(self, core: Core) -> NameReading:
        ways = self.ways[core.name]
        kind = self._kind_without_place(core, ways)
        if kind:
            return NameReading(core.name, (), kind, "")
        total = sum(way.weight for way in ways)
        odds: dict[tuple[str, str], float] = defaultdict(float)
        sides: dict[str, float] = defaultdict(float)
        for way in ways:
            share = way.weight / total
            sides[_side(way)] += share
            for place, probability in self._places(way).items():
                odds[place] += share * probability
        places = [NamedPlace(*place, p) for place, p in odds.items() if p >= _LEAST]
        places.sort(key=lambda place: (-place.probability, place.segment, place.landmark))
        side = max(sides, key=lambda name: sides[name])
        return NameReading(
            core.name,
            tuple(places),
            self._kind(core, ways[0]) if places else "unknown",
            side if places and sides[side] >= _MOSTLY else "",
        )

    def _kind_without_place(self, core: Core, ways: Sequence[_Way]) -> str:
        """Kind of a name without a place of the body, "" for one with a place."""
        dictionary, tokens = self.dictionary, set(tokens_of(core.core))
        if self._frame(core) and ways:
            return ""
        rests = {guess.rest for guess in side_guesses(core.core)}
        if tokens & dictionary.objects:
            return "object"
        if self._is_axis("".join(tokens_of(core.core))):
            return "computed"
        if (tokens | ({ways[0].guess.rest} if ways else rests)) & dictionary.computed:
            return "computed"
        if not ways and self._is_output("".join(tokens_of(core.core))):
            return "computed"
        if ways:
            return ""
        objects = dictionary.objects | dictionary.lone_objects
        stems = {re.sub(r"\d+$", "", text) for text in tokens | rests}
        named = any(
            stem in objects or (len(word) > _SHORTEST_OBJECT and stem.startswith(word))
            for stem in stems
            for word in objects
        )
        return "object" if named else "unknown"

    def _kind(self, core: Core, way: _Way) -> str:
        modifiers = way.parse.modifiers
        if "made" in modifiers or self._virtual(core):
            return "computed"
        if self.keypoints:
            return "keypoint"
        group = way.parse.group
        two = group.sided is not None or _paired(group.places)
        between = "middle" in modifiers and not way.guess.side and two
        return "computed" if between or "centre" in modifiers else group.kind

    def _places(self, way: _Way) -> dict[tuple[str, str], float]:
        """Probability by segment and landmark of one way to read a name."""
        group = way.parse.group
        side = way.guess.side
        odds, landmarks = way.parse.places(bool(side), self.company)
        if self.keypoints and group.keypoint and group.keypoint not in odds:
            odds = {group.keypoint: sum(odds.values())}
        landmarks = landmarks and "made" not in way.parse.modifiers
        result: dict[tuple[str, str], float] = defaultdict(float)
        for place, probability in odds.items():
            for (segment, landmark), share in _on_body(place, side).items():
                result[segment, landmark if landmarks else ""] += share * probability
        return result


def _counts_alone(guess: SideGuess, styles: Mapping[str, float]) -> bool:
    """True where a side counts without the marker of the other side."""
    return guess.style not in NEEDS_PARTNER or styles.get(guess.style, 0.0) > _CONVENTION


def _side(way: _Way) -> str:
    if way.guess.side:
        return way.guess.side
    return "middle" if way.parse.group.middle or _unpaired_landmarks(way.parse.group.places) else ""


def _paired(odds: Odds) -> bool:
    return any(f"right_{place}" in load_body(BODY).landmarks for place in odds)


def _unpaired_landmarks(odds: Odds) -> bool:
    landmarks = load_body(BODY).landmarks
    return bool(odds) and all(place in landmarks for place in odds)


def _on_body(place: str, side: str) -> dict[tuple[str, str], float]:
    """Segments and landmarks of a place of the dictionary, each with its share for a name without a side."""
    body = load_body(BODY)
    segments = {segment.name for segment in body.segments}
    if place in body.landmarks:
        return {(body.landmark(place).segment, place): 1.0}
    if place in segments:
        return {(place, ""): 1.0}
    found = {}
    for one in (side,) if side else ("right", "left"):
        sided = f"{one}_{place}"
        segment = sided if sided in segments else body.landmark(sided).segment
        found[segment, "" if sided in segments else sided] = 1.0 if side else 0.5
    return found
