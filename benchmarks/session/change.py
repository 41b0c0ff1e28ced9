"""Two sessions of one synthetic person whose gait changes by a known amount: she walks with bent knees.

The knees' straightest moment is 10° less straight. They are then bent by 5° more on the mean of the cycle and by 8° in
mid-stance, where their torques are larger by 0.26 N m/kg; how much at each point is known from the motions. Between the
sessions the markers are put on anew, and each session has its own standing trial and its own scaled body, as in a
laboratory.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.io.truth import Truth
from mbkf.model.body import Body
from mbkf.model.body_file import load_body
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.model.protocol import load_protocol
from mbkf.numerics.threads import single_threaded
from mbkf.synthesis.motions import motion_names, register_motion
from mbkf.synthesis.person import PLACEMENT_SD_M, body_of, synthesise_subject
from mbkf.synthesis.plan import MotionPlan
from mbkf.synthesis.walk import walk_plan
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale
from mbkf.trial.synth import synthesise

BENT_RAD = float(np.deg2rad(10.0))
"""How much more the knees are bent at their straightest in the second session."""

TRIALS, SECONDS = 3, 3.5

MOTIONS = ("walk", "bent walk")


def bent_walk_plan(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    """The walk of the same random numbers with knees that stay bent.

    Args:
        model: The body that walks.
        seconds: Duration of the recorded window, s.
        rng: Source of the differences between persons.
    """
    plan = walk_plan(model, seconds, rng)
    return replace(plan, straightest_rad=plan.straightest_rad + BENT_RAD)


def register_bent_walk() -> None:
    """Makes the bent walk a motion that can be synthesised."""
    if MOTIONS[1] not in motion_names(static=True):
        register_motion(MOTIONS[1], seconds=5.0, trial=False)(bent_walk_plan)


@dataclass(frozen=True)
class Recorded:
    """The trials of a session as they are estimated, and the same with true angles and torques."""

    estimated: tuple[Reconstruction, ...]
    true: tuple[Reconstruction, ...]


def recorded(seed: int) -> tuple[Recorded, Recorded]:
    """Both sessions of a person."""
    register_bent_walk()
    with single_threaded():
        person = synthesise_subject(seed)
        return _session(person, MOTIONS[0], seed, 0), _session(marked_anew(person, seed), MOTIONS[1], seed, 1)


def _session(person: Subject, motion: str, seed: int, number: int) -> Recorded:
    made = [
        synthesise(motion, seconds=SECONDS, seed=1000 * seed + 10 * number + k, subject=person)[1]
        for k in range(TRIALS)
    ]
    subject = scale(made[0].static, [], mass_kg=person.mass_kg, protocol=person.protocol)
    settings = ReconstructSettings(checks=False)
    found = [reconstruct(one.trial, subject, settings=settings) for one in made]
    named = [replace(r, trial=f"{motion} {k}") for k, r in enumerate(found)]
    return Recorded(
        tuple(named), tuple(_true(r, one.truth, person) for r, one in zip(named, made, strict=True))
    )


def _true(r: Reconstruction, truth: Truth, person: Subject) -> Reconstruction:
    """A result with the true angles, rates and torques in place of the estimated ones."""
    clinical = ClinicalAngles(body_of(person))
    angles = clinical.angles(truth.q)
    return replace(
        r,
        angles=angles,
        angle_rates=np.einsum("tan,tn->ta", clinical.rate_matrices(truth.q, angles), truth.v),
        moments=clinical.moments(truth.q, truth.tau, angles),
    )


def marked_anew(person: Subject, seed: int) -> Subject:
    """The same person with the markers put on again, as the seed says."""
    rng = np.random.default_rng([seed, 77])
    model, description = HumanModel.of(person), load_body(person.body)
    protocol = {marker.name: marker for marker in load_protocol(person.protocol).markers}

    def place(name: str) -> Array:
        marker = protocol[name]
        offset = np.clip(rng.normal(size=3), -2.5, 2.5) * PLACEMENT_SD_M[marker.kind]
        return model.axis_scale(description.segment(marker.segment)) * marker.position_m + offset

    return replace(person, markers=tuple(replace(m, position_m=place(m.name)) for m in person.markers))
