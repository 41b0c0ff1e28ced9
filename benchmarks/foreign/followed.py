"""Persons who are scaled and followed as a laboratory would do it, through the public functions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from benchmarks.foreign.centres import hip_in_pelvis
from benchmarks.foreign.errors import Judged, judged
from benchmarks.foreign.truth import Foreigner
from mbkf.conventions import SIDES
from mbkf.numerics.threads import single_threaded
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale

SCALINGS: dict[str, tuple[str, ...]] = {"static": (), "walk": ("walk",), "session": ("walk", "squat")}
"""Motions from which a person is scaled beside standing, by the scaling's name."""

WITHOUT_PLATES = ("jump",)
"""Motions that are only asked for by name: rows of all motions, and the baseline of their medians, are older."""

SMOOTHED, CAUSAL = "smoothed", "causal"
FILTERS = (SMOOTHED, CAUSAL)


@dataclass(frozen=True)
class Job:
    """One person, scaled once.

    Attributes:
        person: The person.
        motions: Motions to follow; empty for all but :data:`WITHOUT_PLATES`.
        scaling: Key of :data:`SCALINGS`.
        filter: "smoothed" or "causal".
    """

    person: Foreigner
    motions: tuple[str, ...] = ()
    scaling: str = "session"
    filter: str = SMOOTHED


def followed(job: Job) -> list[Judged]:
    """Errors of every motion of a job.

    Args:
        job: Person, scaling and motions; motions of the scaling that were not recorded are left out.
    """
    person = job.person
    with single_threaded():
        held = [person.trial(name) for name in SCALINGS[job.scaling] if name in person.motions]
        subject = scale(person.static(), held, mass_kg=person.mass_kg)
        truths = {name: person.truth(name) for name in person.motions}
        wanted = job.motions or [name for name in person.motions if name not in WITHOUT_PLATES]
        hips = {side: hip_in_pelvis(list(truths.values()), side) for side in SIDES}
        settings = ReconstructSettings(smooth=job.filter == SMOOTHED, checks=False)
        return [
            judged(
                person.name,
                name,
                reconstruct(person.trial(name), subject, settings=settings),
                truths[name],
                hips,
            )
            for name in wanted
            if name in person.motions
        ]


def jobs(
    persons: Sequence[Foreigner],
    scaling: str,
    motions: Sequence[str] = (),
    filter: str = SMOOTHED,
) -> list[Job]:
    """One job for each person.

    Args:
        persons: The persons.
        scaling: Key of :data:`SCALINGS`.
        motions: Motions to follow; empty for all.
        filter: "smoothed" or "causal".
    """
    return [Job(person, tuple(motions), scaling, filter) for person in persons]
