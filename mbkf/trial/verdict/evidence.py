"""The evidence on a trial as numbers: whatever was found out about it, from any way in, that bears on its use."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from mbkf.io.contacts import FEET, ContactInterval
from mbkf.io.findings import Finding
from mbkf.io.limb_doubts import LimbDoubt
from mbkf.io.results import Reconstruction
from mbkf.io.static_exchanges import static_exchanges
from mbkf.io.subject import Subject
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.io.verdict import LOAD_PARTS, MOTION_PARTS
from mbkf.model.description import BodyDescription
from mbkf.scaling.verdict import DOUBTS_KEY
from mbkf.trial.verdict.fit import PartFit
from mbkf.trial.verdict.holes import Hole, holes
from mbkf.trial.verdict.parts import PELVIS, TRUNK, main_segments, part_of_segment
from mbkf.trial.verdict.ranges import Beyond
from mbkf.trial.verdict.standing import Stood, stood_bent
from mbkf.trial.verdict.sums import TrialSums


@dataclass(frozen=True)
class Evidence:
    """Evidence on a trial; every field has a default that speaks for the trial.

    Attributes:
        tracked: Share of the frames in which the body was followed.
        unshown: Parts that no instrument shows.
        unshown_segments: Segments by part that no instrument shows, of parts that others show.
        holes: Segments without markers between others with some.
        fits: Fit of the markers of each part that shows any.
        beyond: Joints beyond their ranges.
        doubtful_limbs: Limbs that were in doubt while the filter ran, and the share of the trial for each.
        spread_deg: Mean standard deviation by part of the flexions that instruments show.
        unexplained: Forces that no contact explains.
        unexplained_share: Share of the frames in which loads are known that such a force spoils.
        contacts: Stretches in which parts besides the feet bear load; nothing measures these.
        checks: Checks of the capture.
        doubts: Doubts of the subject's file.
        stood: Joints of the legs that were bent in the static trial, where no one stands bent.
        static_exchanges: Pairs of names of the static trial that scaling put right, with the parts of their segments.
        explained: Share of the capture's markers that the protocol knows.
        part_of: Part by segment of the body.
    """

    tracked: float = 1.0
    unshown: tuple[str, ...] = ()
    unshown_segments: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    holes: tuple[Hole, ...] = ()
    fits: tuple[PartFit, ...] = ()
    beyond: tuple[Beyond, ...] = ()
    doubtful_limbs: tuple[tuple[LimbDoubt, float], ...] = ()
    spread_deg: Mapping[str, float] = field(default_factory=dict)
    unexplained: tuple[UnexplainedLoad, ...] = ()
    unexplained_share: float = 0.0
    contacts: tuple[ContactInterval, ...] = ()
    checks: tuple[Finding, ...] = ()
    doubts: tuple[str, ...] = ()
    stood: tuple[Stood, ...] = ()
    static_exchanges: tuple[tuple[str, str, tuple[str, ...]], ...] = ()
    explained: float = 1.0
    part_of: Mapping[str, str] = field(default_factory=dict)

    @property
    def trunk_shown(self) -> bool:
        """True where instruments show the trunk, half of a person's mass: without it Newton's law shows little."""
        modelled = not self.part_of or TRUNK in self.part_of.values()
        return modelled and TRUNK not in self.unshown


@dataclass(frozen=True)
class Found:
    """Evidence beside the sums over frames, as far as it is known.

    Attributes:
        limb_doubts: Limbs that were in doubt.
        unexplained: Forces that no contact explains.
        contacts: Stretches in which parts bear load, the feet's included.
        checks: Checks of the capture.
        explained: Share of the capture's markers that the protocol knows.
        smoothed: Later frames corrected earlier ones.
    """

    limb_doubts: tuple[LimbDoubt, ...] = ()
    unexplained: tuple[UnexplainedLoad, ...] = ()
    contacts: tuple[ContactInterval, ...] = ()
    checks: tuple[Finding, ...] = ()
    explained: float = 1.0
    smoothed: bool = False


def evidence_of(r: Reconstruction) -> Evidence:
    """The evidence that a result holds.

    Args:
        r: The result, with its checks.
    """
    found = Found(r.limb_doubts, r.unexplained, r.contacts, r.checks, r.markers_explained, r.smoothed)
    return evidence_from(TrialSums.of(r), found)


def evidence_from(sums: TrialSums, found: Found) -> Evidence:
    """The evidence of a trial, or of a live run so far.

    Args:
        sums: Sums over its frames.
        found: The other evidence.
    """
    followed = sums.followed
    model, body = followed.model, followed.model.description
    lacking = _lacking(sums, body)
    main = main_segments(body)
    unshown = tuple(part for part in MOTION_PARTS if main[part] and all(one in lacking for one in main[part]))
    loads: tuple[str, ...] = () if sums.known else LOAD_PARTS
    if TRUNK in unshown and not loads:
        loads = ("trunk_loads",)
    frames = max(sums.frames, 1)
    return Evidence(
        tracked=sums.tracked / frames,
        unshown=(*unshown, *loads),
        unshown_segments={
            part: tuple(one for one in main[part] if one in lacking)
            for part in MOTION_PARTS
            if part not in unshown and any(one in lacking for one in main[part])
        },
        holes=_holes(sums, part_of_segment(body)),
        fits=sums.fits(),
        beyond=sums.beyond(),
        doubtful_limbs=_doubtful_limbs(found, sums.frames, followed.rate_hz),
        spread_deg=_spreads(sums, body, lacking),
        unexplained=found.unexplained,
        unexplained_share=sums.spoilt / max(sums.known, 1),
        contacts=tuple(one for one in found.contacts if one.part not in FEET),
        checks=found.checks,
        doubts=doubts_of(followed.subject),
        stood=stood_bent(model, followed.subject),
        static_exchanges=_static_exchanges(followed.subject, part_of_segment(body)),
        explained=found.explained,
        part_of=part_of_segment(body),
    )


def doubts_of(subject: Subject) -> tuple[str, ...]:
    """Doubts about the scaled body, from its file."""
    doubts = subject.report.get(DOUBTS_KEY)
    return tuple(str(one) for one in doubts) if isinstance(doubts, list) else ()


def _static_exchanges(
    subject: Subject, part_of: Mapping[str, str]
) -> tuple[tuple[str, str, tuple[str, ...]], ...]:
    """The pairs of names that the static trial exchanges, and the parts that rest on them."""
    segments = {marker.name: marker.segment for marker in subject.markers}
    return tuple(
        (a, b, tuple(dict.fromkeys(part_of[segments[one]] for one in (a, b) if one in segments)))
        for a, b in static_exchanges(subject)
    )


def _lacking(sums: TrialSums, body: BodyDescription) -> frozenset[str]:
    """Segments that no instrument shows: all of their dofs are held, or the root without a marker of its own."""
    followed = sums.followed
    held = set(followed.unobserved_dofs)
    of_segment: dict[str, list[str]] = {}
    for name in followed.dof_names:
        of_segment.setdefault(name.rsplit("_", 1)[0], []).append(name)
    found = {segment for segment, names in of_segment.items() if all(name in held for name in names)}
    own = {marker.name: marker.segment for marker in followed.subject.markers}
    shown = {own[name] for name in sums.seen}
    if followed.marker_names and body.roles.root not in shown:
        found.add(body.roles.root)
    return frozenset(found)


def _holes(sums: TrialSums, part_of: Mapping[str, str]) -> tuple[Hole, ...]:
    """Segments without a seen marker between others with some; nothing where no marker is followed."""
    followed = sums.followed
    if not followed.marker_names:
        return ()
    own = {marker.name: marker.segment for marker in followed.subject.markers}
    marked = frozenset(own[name] for name in sums.seen)
    unobservable = np.isin(followed.dof_names, followed.unobserved_dofs)
    return holes(followed.model, marked, unobservable, part_of, sums.mean_sd())


def _doubtful_limbs(found: Found, frames: int, rate_hz: float) -> tuple[tuple[LimbDoubt, float], ...]:
    """Limbs in doubt with the share of the trial; mended ones of a smoothed result have their better pose all along."""
    lasts_s = max(frames / rate_hz, 1e-9)
    kept = [one for one in found.limb_doubts if not (one.mended and found.smoothed)]
    return tuple((one, min((one.to_s - one.from_s + 1.0 / rate_hz) / lasts_s, 1.0)) for one in kept)


def _spreads(sums: TrialSums, body: BodyDescription, lacking: frozenset[str]) -> dict[str, float]:
    """Largest mean standard deviation by part among the flexions of its main joints that are shown."""
    part, main, mean_sd = part_of_segment(body), main_segments(body), sums.mean_sd()
    found: dict[str, float] = {}
    for joint in body.clinical_joints:
        each = part[joint.distal]
        if joint.distal in lacking or joint.distal not in main[each] or joint.main not in mean_sd:
            continue
        if each != PELVIS:
            found[each] = max(found.get(each, 0.0), float(np.rad2deg(mean_sd[joint.main])))
    return found
