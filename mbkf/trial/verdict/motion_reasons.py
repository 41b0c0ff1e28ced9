"""Reasons against the motion of a part: its markers, its joints' ranges, its spreads, the scaled body, tracking.

Bounds were set on sixty right trials (public captures and persons made from OpenSim bodies) and on forty with a
fault; ``python -m benchmarks verdict`` prints the words on these and on others.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from mbkf.io.verdict import LOAD_PARTS, MOTION_PARTS, TITLES, Reason, Word
from mbkf.numerics.printed import percent
from mbkf.trial.verdict.evidence import Evidence
from mbkf.trial.verdict.parts import ARMS, TRUNK
from mbkf.trial.verdict.standing import Stood


class Bounds(NamedTuple):
    """Sizes from which a number calls for a look, and from which a result is not to be used."""

    look: float
    leave: float

    def reached(self, size: float) -> tuple[Word, float] | None:
        """The word on a number and its size over the word's bound; None below both bounds."""
        if size >= self.leave:
            return "do not use", size / self.leave
        return ("look", size / self.look) if size >= self.look else None


FIT = Bounds(1.5, 2.5)
"""Distance of a part's markers from the body over their noise: at most 1.1 in right trials, from 2.6 on where names are
crossed or plates drag the body off its markers."""

INNOVATION = Bounds(2.2, 4.0)
"""Innovation squared of a part's markers per coordinate: at most 1.9 in right trials."""

RANGE_DEG = Bounds(4.0, 10.0)
"""Excess of a joint over its range for longer than an instant: at most 2.5° in right trials."""

SPREAD_DEG = Bounds(10.0, 20.0)
ARM_SPREAD_DEG = Bounds(20.0, 40.0)
"""Standard deviation of flexions: at most 8.5° in right trials, of arms 16°."""

REFUSED = Bounds(0.1, 0.3)
"""Share of a part's samples that were refused."""

STOOD_DEG = Bounds(30.0, 45.0)
"""Rotation of a joint of a leg in the static trial: at most 21° in right ones, from 93° on where names are crossed."""

IN_DOUBT = Bounds(0.05, 0.2)
"""Share of the trial in which a limb was in doubt."""

UNTRACKED = Bounds(0.05, 0.5)
"""Share of the frames in which the body was not followed."""

UNEXPLAINED_MARKERS = Bounds(0.4, 0.7)
"""Share of the capture's markers that the protocol does not know."""

BETWEEN = "its pose follows from the segments on both sides and the usual posture"
"""Meaning of a hole for the results."""

CHECK_NAMES = "check the names of its markers, and that the subject file belongs to this person"


def motion_reasons(evidence: Evidence) -> Iterator[Reason]:
    """All reasons against motions of parts.

    Args:
        evidence: The evidence.
    """
    yield from _not_shown(evidence)
    yield from _holes(evidence)
    yield from _fits(evidence)
    yield from _ranges(evidence)
    yield from _doubtful_limbs(evidence)
    yield from _stood(evidence)
    yield from _static_exchanges(evidence)
    yield from _spreads(evidence)
    yield from _whole(evidence)


def _not_shown(evidence: Evidence) -> Iterator[Reason]:
    for part in evidence.unshown:
        if part in LOAD_PARTS:
            yield Reason(
                part,
                "do not use",
                "no frame in which every load is known",
                "torques rest on loads that nothing reads",
                "record both feet on plates, or use the motion alone",
                shown=False,
            )
        else:
            hole = next((one for one in evidence.holes if one.parts[0] == part), None)
            yield Reason(
                part,
                "do not use",
                "the capture shows nothing of it" if hole is None else hole.found,
                "its angles are those of the usual posture" if hole is None else BETWEEN,
                "put markers on it if it matters" if hole is None else hole.remedy,
                shown=False,
            )
    for part, segments in evidence.unshown_segments.items():
        names = ", ".join(one.replace("_", " ") for one in segments)
        yield Reason(
            part,
            "look",
            f"no marker shows the {names}",
            "angles beside it are guessed from the usual posture",
            "put markers on it, or use the other joints alone",
        )


def _holes(evidence: Evidence) -> Iterator[Reason]:
    """Reasons against the parts beside segments without markers."""
    for hole in evidence.holes:
        for part in hole.parts:
            if part not in evidence.unshown:
                yield Reason(part, "look", hole.found, BETWEEN, hole.remedy)


def _fits(evidence: Evidence) -> Iterator[Reason]:
    for fit in evidence.fits:
        title = TITLES[fit.part]
        off = FIT.reached(fit.per_noise)
        if off is not None:
            yield Reason(
                fit.part,
                off[0],
                f"markers of the {title} lie {fit.rms_mm:.0f} mm from the body, {fit.per_noise:.1f} times as far as "
                f"their noise explains; worst is {fit.worst}",
                "the body is not posed as these markers are",
                CHECK_NAMES,
                off[1],
            )
        moving = None if fit.nis is None else INNOVATION.reached(fit.nis)
        if moving is not None:
            yield Reason(
                fit.part,
                moving[0],
                f"innovations of the markers of the {title} are {fit.nis:.1f} per reading, 1 in a coherent trial",
                "the body moves otherwise than these markers",
                "check their names, and plates and clocks",
                moving[1],
            )
        refused = REFUSED.reached(fit.refused)
        if refused is not None:
            yield Reason(
                fit.part,
                refused[0],
                f"{percent(fit.refused)} of the samples of the {title} were refused",
                "the motion rests on the others",
                "check names and reflections",
                refused[1],
            )


def _ranges(evidence: Evidence) -> Iterator[Reason]:
    for one in evidence.beyond:
        off = RANGE_DEG.reached(one.excess_deg)
        if off is not None:
            yield Reason(
                one.part,
                off[0],
                f"the joint of the {one.joint.replace('_', ' ')} is {one.excess_deg:.0f}° beyond its range, "
                f"{one.seconds:.1f} s in all",
                "a limb may be turned over, or its markers exchanged",
                CHECK_NAMES,
                off[1],
            )


def _doubtful_limbs(evidence: Evidence) -> Iterator[Reason]:
    """Limbs that the filter had in doubt for long enough, a mended one until then."""
    for one, share in evidence.doubtful_limbs:
        off = IN_DOUBT.reached(share)
        if off is None:
            continue
        yield Reason(
            evidence.part_of.get(one.limb, TRUNK),
            "look" if one.mended else off[0],
            one.sentence,
            f"{percent(share)} of the trial have a pose in doubt",
            "look at the limb in 3-D then" if one.mended else CHECK_NAMES,
            off[1],
        )


def _stood(evidence: Evidence) -> Iterator[Reason]:
    """The joint of each leg that was bent most in the static trial."""
    worst: dict[str, Stood] = {}
    for one in evidence.stood:
        worst.setdefault(one.part, one)
    for part, one in worst.items():
        off = STOOD_DEG.reached(abs(one.degrees))
        if off is not None:
            yield Reason(
                part,
                off[0],
                f"in the static trial the joint of the {one.segment.replace('_', ' ')} is turned by {one.degrees:.0f}°",
                "no one stands so: the body was scaled from exchanged or misplaced markers",
                "check the names of the static trial's markers, and scale again",
                off[1],
            )


def _static_exchanges(evidence: Evidence) -> Iterator[Reason]:
    """Names of the static trial that scaling put right by the fit of the body, once for each part."""
    pairs: dict[str, list[str]] = {}
    for a, b, parts in evidence.static_exchanges:
        for part in parts:
            pairs.setdefault(part, []).append(f"{a} and {b}")
    for part, named in pairs.items():
        yield Reason(
            part,
            "look",
            f"the static trial exchanges the names of {', '.join(named)}",
            "scaling put them right by the fit of the body, which is a guess",
            "check these names in the static trial; scale --keep-names keeps them",
            1.0,
        )


def _spreads(evidence: Evidence) -> Iterator[Reason]:
    for part, sd in evidence.spread_deg.items():
        off = (ARM_SPREAD_DEG if part in ARMS else SPREAD_DEG).reached(sd)
        if off is not None and part not in evidence.unshown:
            yield Reason(
                part,
                off[0],
                f"flexions of the {TITLES[part]} have standard deviations of {sd:.0f}°",
                "too few markers show them",
                "use them with their intervals, or add markers",
                off[1],
            )


def _whole(evidence: Evidence) -> Iterator[Reason]:
    """Reasons against the motion of all parts that are shown."""
    found: list[tuple[tuple[Word, float], str, str, str]] = []
    lost = UNTRACKED.reached(1.0 - evidence.tracked)
    if lost is not None:
        found.append(
            (
                lost,
                f"the body was not followed in {percent(1.0 - evidence.tracked)} of the frames",
                "these frames are left out",
                "check unit, axes and marker names",
            )
        )
    unknown = UNEXPLAINED_MARKERS.reached(1.0 - evidence.explained)
    if unknown is not None:
        found.append(
            (
                unknown,
                f"the protocol knows {percent(evidence.explained)} of the capture's markers",
                "the subject file belongs to another marker set, and perhaps to another person",
                "take the subject file of this person, or scale again with the right --protocol",
            )
        )
    for doubt in evidence.doubts:
        found.append(
            (("look", 1.0), f"the subject file: {doubt}", "the body may be another's", "scale again")
        )
    for (word, weight), what, means, todo in found:
        for part in MOTION_PARTS:
            if part not in evidence.unshown:
                yield Reason(part, word, what, means, todo, weight)
