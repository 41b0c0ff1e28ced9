"""Eight synthetic persons like those of the thesis (its 4.2): four women, four men, 20 to 32 years, 49.75 to 85 kg."""

from __future__ import annotations

from dataclasses import dataclass

from mbkf.io.subject import Subject
from mbkf.synthesis.person import synthesise_subject

FIRST_SEED = 100
"""Seed of the first person's proportions and marker places; the next ones follow."""


@dataclass(frozen=True)
class Person:
    """A person of the study: ``sex`` ("W" or "M"), ``age_years``, ``height_m``, ``mass_kg``."""

    sex: str
    age_years: int
    height_m: float
    mass_kg: float

    @property
    def label(self) -> str:
        """As tables and figures name the person."""
        return f"{self.sex} {self.age_years}, {self.mass_kg:g} kg"


PERSONS = (
    Person("W", 22, 1.58, 49.75),
    Person("W", 20, 1.63, 55.5),
    Person("W", 27, 1.67, 60.0),
    Person("W", 24, 1.70, 66.0),
    Person("M", 21, 1.73, 68.0),
    Person("M", 29, 1.77, 72.5),
    Person("M", 32, 1.81, 78.0),
    Person("M", 30, 1.86, 85.0),
)
"""The thesis names the woman of 49.75 kg (squat) and the men of 78 kg (general movement) and 85 kg (jump)."""

OF_SQUAT, OF_GENERAL, OF_JUMP = 0, 6, 7


def subject_of(number: int) -> Subject:
    """The subject with exactly known body and marker places.

    Args:
        number: Place in :data:`PERSONS`.
    """
    person = PERSONS[number]
    return synthesise_subject(FIRST_SEED + number, height_m=person.height_m, mass_kg=person.mass_kg)
