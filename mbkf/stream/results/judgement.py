"""The judgement of a live run so far: the verdict on its results, and the limbs that were in doubt."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from mbkf.io.limb_doubts import LimbDoubt
from mbkf.io.verdict import PARTS, WORDS, Verdict


@dataclass(frozen=True)
class Judgement:
    """The judgement of a live run at one time; a new record wherever it changes.

    Attributes:
        verdict: Which results may be used.
        time_s: Time of the last frame that it knows, s from the first one.
        limb_doubts: Limbs in doubt so far, mended or not; times in s from the first frame.
        notices: Remarks on the stream: another person in view, exchanged names, a stream chosen among several.
    """

    verdict: Verdict
    time_s: float
    limb_doubts: tuple[LimbDoubt, ...] = ()
    notices: tuple[str, ...] = ()

    @property
    def codes(self) -> tuple[float, ...]:
        """Words on the trial and on each of :data:`mbkf.io.verdict.PARTS` as numbers: 0 use, 1 look, 2 do not use."""
        parts = self.verdict.parts
        return tuple(
            float(WORDS.index(word)) for word in (self.verdict.overall, *(parts[one] for one in PARTS))
        )

    def plain(self) -> dict[str, object]:
        """As plain data: the verdict as in ``summary.json``, its line and sentences, remarks and limbs."""
        return {
            **self.verdict.as_table(),
            "line": self.verdict.line,
            "sentences": list(self.verdict.sentences),
            "time_s": self.time_s,
            "notices": list(self.notices),
            "limb_doubts": [asdict(one) | {"sentence": one.sentence} for one in self.limb_doubts],
        }
