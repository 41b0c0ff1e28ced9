"""The verdict on a trial: which of its results may be used, part by part, and the reasons in order of their weight."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal, TypedDict, cast, get_args

from mbkf.errors import InvalidInput

Word = Literal["use", "look", "do not use"]
"""Right as far as the evidence goes; to be checked by a person; wrong, or not known."""

WORDS: tuple[Word, ...] = get_args(Word)

MOTION_PARTS = ("pelvis", "trunk", "right_leg", "left_leg", "right_arm", "left_arm")
LOAD_PARTS = ("right_leg_loads", "left_leg_loads", "trunk_loads")
PARTS = (*MOTION_PARTS, *LOAD_PARTS)
"""Results of a trial that are judged: the motion of parts of the body, and loads on them."""

TITLES: Mapping[str, str] = {
    **{one: one.replace("_", " ") for one in MOTION_PARTS},
    "right_leg_loads": "loads of the right leg",
    "left_leg_loads": "loads of the left leg",
    "trunk_loads": "loads of the trunk",
}
"""Names of parts in sentences."""

PAIRS = {
    ("right_leg", "left_leg"): "both legs",
    ("right_arm", "left_arm"): "both arms",
    ("right_leg_loads", "left_leg_loads"): "loads of both legs",
}
"""Names of both sides together."""


class ReasonTold(TypedDict):
    """One piece of evidence against a part as plain data (:class:`Reason`).

    Attributes:
        part: The part.
        word: "look" or "do not use".
        found, means, do: The finding with its number and unit, its meaning, the remedy.
        weight: Size of the finding over the bound of its word.
        shown: False where the capture does not show the part at all.
    """

    part: str
    word: str
    found: str
    means: str
    do: str
    weight: float
    shown: bool


class VerdictTold(TypedDict):
    """The verdict on a trial as plain data (:class:`Verdict`).

    Attributes:
        overall: "use", "look" or "do not use": the gravest word on a part that the capture shows.
        parts: The same by part.
        reasons: The gravest first.
    """

    overall: str
    parts: dict[str, str]
    reasons: list[ReasonTold]


@dataclass(frozen=True)
class Reason:
    """One piece of evidence against a part.

    Attributes:
        part: One of :data:`PARTS`.
        word: "look" or "do not use".
        found: The finding, with number, unit and name.
        means: Its meaning for the results.
        do: Remedy.
        weight: Size of the finding over the bound of its word; the largest stands first.
        shown: False where the capture does not show the part at all: it is not to be used, but the trial is not worse
            for it.
    """

    part: str
    word: Word
    found: str
    means: str
    do: str
    weight: float = 1.0
    shown: bool = True

    def __post_init__(self) -> None:
        """Refuses an unknown part or word.

        Raises:
            InvalidInput: One of them is unknown.
        """
        if self.part not in PARTS or self.word not in WORDS:
            raise InvalidInput(f"reason of a verdict: unknown part '{self.part}' or word '{self.word}'")

    @property
    def sentence(self) -> str:
        """The reason in words, without its part."""
        return f"{self.found}: {self.means}; {self.do}"


@dataclass(frozen=True)
class Verdict:
    """The verdict on a trial.

    Attributes:
        reasons: All reasons, the gravest word first, then by weight.
    """

    reasons: tuple[Reason, ...] = ()

    @classmethod
    def of(cls, reasons: Iterable[Reason]) -> Verdict:
        """The verdict of reasons in any order."""
        return cls(tuple(sorted(reasons, key=_rank)))

    @property
    def parts(self) -> dict[str, Word]:
        """The word on each of :data:`PARTS`: the gravest of its reasons."""
        return {part: gravest(one.word for one in self.reasons if one.part == part) for part in PARTS}

    @property
    def overall(self) -> Word:
        """The gravest word on a part that the capture shows; "do not use" where it shows no part."""
        if not self.shown:
            return WORDS[-1]
        return gravest(one.word for one in self.reasons if one.part in self.shown)

    @property
    def shown(self) -> tuple[str, ...]:
        """The parts that the capture shows."""
        hidden = {one.part for one in self.reasons if not one.shown}
        return tuple(part for part in PARTS if part not in hidden)

    @property
    def loads_usable(self) -> bool:
        """True where no loads that the capture shows are to be left alone."""
        parts = self.parts
        return all(parts[part] != WORDS[-1] for part in LOAD_PARTS if part in self.shown)

    def may_use(self, part: str) -> bool:
        """True for a part that is not to be left alone; of one that is to be looked at, too.

        Args:
            part: One of :data:`PARTS`.
        """
        return self.parts[part] != WORDS[-1]

    @property
    def line(self) -> str:
        """The verdict in one line: the word, its parts, and the gravest reason."""
        hidden = [part for part in PARTS if part not in self.shown]
        left_out = f" (not shown: {listed(hidden)})" if hidden else ""
        grave = [one for one in self.reasons if one.word == self.overall and one.part in self.shown]
        if not grave:
            return f"{self.overall}{left_out}"
        parts = dict.fromkeys(one.part for one in grave)
        return f"{self.overall}: {listed(parts)}{left_out}; {grave[0].sentence}"

    @property
    def sentences(self) -> tuple[str, ...]:
        """The reasons against parts that are shown in words, alike ones of several parts together, gravest first."""
        together: dict[tuple[str, Word], list[str]] = {}
        for one in self.reasons:
            if one.part not in self.shown:
                continue
            together.setdefault((one.sentence, one.word), []).append(one.part)
        return tuple(f"{word}: {listed(parts)}; {text}" for (text, word), parts in together.items())

    def as_table(self) -> VerdictTold:
        """As plain data."""
        reasons = [cast(ReasonTold, asdict(one)) for one in self.reasons]
        return {"overall": self.overall, "parts": dict(self.parts), "reasons": reasons}

    @classmethod
    def of_table(cls, table: Mapping[str, object]) -> Verdict:
        """The verdict of plain data.

        Raises:
            InvalidInput: The reasons are no list of reasons.
        """
        reasons = table.get("reasons")
        try:
            return cls.of(Reason(**one) for one in cast(list[dict[str, Any]], reasons))
        except TypeError as error:
            raise InvalidInput(
                f"verdict: 'reasons' cannot be read as a list of reasons ({error}); reconstruct the trial again"
            ) from error


def gravest(words: Iterable[Word]) -> Word:
    """The gravest of words, "use" without any."""
    return max(words, key=WORDS.index, default=WORDS[0])


def listed(parts: Iterable[str]) -> str:
    """Parts in a sentence, both sides of a pair together."""
    left = list(parts)
    for pair, title in PAIRS.items():
        if all(part in left for part in pair):
            left[left.index(pair[0])] = title
            left.remove(pair[1])
    return ", ".join(TITLES.get(part, part) for part in left)


def verdict_of_text(text: str) -> Verdict | None:
    """The verdict of JSON; None of "null"."""
    table = json.loads(text)
    return None if table is None else Verdict.of_table(table)


def _rank(one: Reason) -> tuple[bool, int, float, int]:
    return not one.shown, -WORDS.index(one.word), -one.weight, PARTS.index(one.part)
