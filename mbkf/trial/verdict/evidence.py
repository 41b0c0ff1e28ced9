"""The evidence on a trial as numbers: whatever was found out about it, from any way in, that bears on its use."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from mbkf.conventions import BoolArray
from mbkf.io.contacts import FEET, ContactInterval
from mbkf.io.findings import Finding
from mbkf.io.limb_doubts import LimbDoubt
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.io.verdict import LOAD_PARTS, MOTION_PARTS
from mbkf.model.description import BodyDescription
from mbkf.model.human import HumanModel
from mbkf.scaling.verdict import DOUBTS_KEY
from mbkf.trial.verdict.fit import PartFit, part_fits
from mbkf.trial.verdict.parts import PELVIS, TRUNK, main_segments, part_of_segment
from mbkf.trial.verdict.ranges import Beyond, joints_beyond
from mbkf.trial.verdict.standing import Stood, stood_bent


@dataclass(frozen=True)
class Evidence:
    """Evidence on a trial; every field has a default that speaks for the trial.

    Attributes:
        tracked: Share of the frames in which the body was followed.
        unshown: Parts that no instrument shows.
        unshown_segments: Segments by part that no instrument shows, of parts that others show.
        fits: Fit of the markers of each part that shows any.
        beyond: Joints beyond their ranges.
        doubtful_limbs: Limbs that were in doubt while the filter ran, and the share of the trial for each.
        spread_deg: Mean standard deviation by part of the flexions that instruments show.
        loads_known: Share of the frames in which every load is known, or would be without an unexplained one.
        unexplained: Forces that no contact explains.
        unexplained_share: Share of the frames in which loads are known that such a force spoils.
        contacts: Stretches in which parts besides the feet bear load; nothing measures these.
        checks: Checks of the capture.
        doubts: Doubts of the subject's file.
        stood: Joints of the legs that were bent in the static trial, where no one stands bent.
        explained: Share of the capture's markers that the protocol knows.
        part_of: Part by segment of the body.
    """

    tracked: float = 1.0
    unshown: tuple[str, ...] = ()
    unshown_segments: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    fits: tuple[PartFit, ...] = ()
    beyond: tuple[Beyond, ...] = ()
    doubtful_limbs: tuple[tuple[LimbDoubt, float], ...] = ()
    spread_deg: Mapping[str, float] = field(default_factory=dict)
    loads_known: float = 1.0
    unexplained: tuple[UnexplainedLoad, ...] = ()
    unexplained_share: float = 0.0
    contacts: tuple[ContactInterval, ...] = ()
    checks: tuple[Finding, ...] = ()
    doubts: tuple[str, ...] = ()
    stood: tuple[Stood, ...] = ()
    explained: float = 1.0
    part_of: Mapping[str, str] = field(default_factory=dict)

    @property
    def trunk_shown(self) -> bool:
        """True where instruments show the trunk, half of a person's mass: without it Newton's law shows little."""
        modelled = not self.part_of or TRUNK in self.part_of.values()
        return modelled and TRUNK not in self.unshown


def evidence_of(r: Reconstruction) -> Evidence:
    """The evidence that a result holds.

    Args:
        r: The result, with its checks.
    """
    model = HumanModel.of(r.subject)
    body = model.description
    lacking = _lacking(r, body)
    main = main_segments(body)
    unshown = tuple(part for part in MOTION_PARTS if main[part] and all(one in lacking for one in main[part]))
    acts = _acting(r)
    known = r.valid | acts
    loads: tuple[str, ...] = () if known.any() else LOAD_PARTS
    if TRUNK in unshown and not loads:
        loads = ("trunk_loads",)
    return Evidence(
        tracked=float(r.tracked.mean()) if r.frames else 0.0,
        unshown=(*unshown, *loads),
        unshown_segments={
            part: tuple(one for one in main[part] if one in lacking)
            for part in MOTION_PARTS
            if part not in unshown and any(one in lacking for one in main[part])
        },
        fits=part_fits(r),
        beyond=joints_beyond(model, r.q, r.tracked, r.rate_hz),
        doubtful_limbs=_doubtful_limbs(r),
        spread_deg=_spreads(r, body, lacking),
        loads_known=float(known.mean()) if r.frames else 0.0,
        unexplained=r.unexplained,
        unexplained_share=float((known & acts).sum() / max(known.sum(), 1)),
        contacts=tuple(one for one in r.contacts if one.part not in FEET),
        checks=r.checks,
        doubts=doubts_of(r.subject),
        stood=stood_bent(model, r.subject),
        explained=r.markers_explained,
        part_of=part_of_segment(body),
    )


def doubts_of(subject: Subject) -> tuple[str, ...]:
    """Doubts about the scaled body, from its file."""
    doubts = subject.report.get(DOUBTS_KEY)
    return tuple(str(one) for one in doubts) if isinstance(doubts, list) else ()


def _lacking(r: Reconstruction, body: BodyDescription) -> frozenset[str]:
    """Segments that no instrument shows: all of their dofs are held, or the root without a marker of its own."""
    held = set(r.unobserved_dofs)
    of_segment: dict[str, list[str]] = {}
    for name in r.dof_names:
        of_segment.setdefault(name.rsplit("_", 1)[0], []).append(name)
    found = {segment for segment, names in of_segment.items() if all(name in held for name in names)}
    own = {marker.name: marker.segment for marker in r.subject.markers}
    shown = {
        own[name]
        for name, seen in zip(r.marker_names, np.asarray(r.present.any(axis=0)), strict=True)
        if seen
    }
    if r.marker_names and body.roles.root not in shown:
        found.add(body.roles.root)
    return frozenset(found)


def _acting(r: Reconstruction) -> BoolArray:
    """(T,) frames in which an unexplained force acts."""
    acts = np.zeros(r.frames, dtype=bool)
    for one in r.unexplained:
        acts |= (r.times_s >= one.from_s - 1e-9) & (r.times_s <= one.to_s + 1e-9)
    return acts


def _doubtful_limbs(r: Reconstruction) -> tuple[tuple[LimbDoubt, float], ...]:
    """Limbs in doubt with the share of the trial; mended ones of a smoothed result have their better pose all along."""
    lasts_s = max(r.frames / r.rate_hz, 1e-9)
    kept = [one for one in r.limb_doubts if not (one.mended and r.smoothed)]
    return tuple((one, min((one.to_s - one.from_s + 1.0 / r.rate_hz) / lasts_s, 1.0)) for one in kept)


def _spreads(r: Reconstruction, body: BodyDescription, lacking: frozenset[str]) -> dict[str, float]:
    """Largest mean standard deviation by part among the flexions of its main joints that are shown."""
    part, main = part_of_segment(body), main_segments(body)
    found: dict[str, float] = {}
    for joint in body.clinical_joints:
        each = part[joint.distal]
        if joint.distal in lacking or joint.distal not in main[each] or joint.main not in r.coordinate_names:
            continue
        sd = r.angle_sd(joint.main)[r.tracked]
        sd = sd[np.isfinite(sd)]
        if len(sd) and each != PELVIS:
            found[each] = max(found.get(each, 0.0), float(np.rad2deg(sd.mean())))
    return found
