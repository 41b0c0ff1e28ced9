"""Persons of our own, made with OpenSim: bodies, movements, loads, skin and captures, in the shared persons' layout."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.dynamic.methods import in_parallel
from benchmarks.foreign.making.capture import (
    NOISE_M,
    misplacements,
    on_skin,
    placed,
    seen,
    shifted,
    static_places,
    with_gaps,
    write_markers,
    write_person,
    write_plates,
    write_truth,
)
from benchmarks.foreign.making.movements import ADDED, MADE, MEASURED, Measured, made, standing, transferred
from benchmarks.foreign.making.osim_body import OsimBody
from benchmarks.foreign.making.persons import MODEL, PERSONS, Person, person_named
from benchmarks.foreign.making.record import Recorded, in_free_flight, recorded
from benchmarks.foreign.making.skin import MODELS
from benchmarks.foreign.truth import FOLDER, Foreigner
from benchmarks.peers.required import opensim

MOVEMENTS = (*MEASURED, *MADE, *ADDED)


@dataclass(frozen=True)
class Order:
    """One person to make.

    Attributes:
        data: Folder of the reference captures.
        out: Where folders of skin models and persons are made.
        person: Name of the person.
        seed: Chooses skin, misplacement, noise and gaps.
    """

    data: Path
    out: Path
    person: str
    seed: int


def make(data: Path, out: Path, seed: int = 0, persons: Sequence[str] = ()) -> None:
    """Makes persons: a folder for each skin model, in it a folder for each person.

    Args:
        data: Folder of the reference captures, which hold the model and the measured movements.
        out: Where they are made.
        seed: Chooses skin, misplacement, noise and gaps.
        persons: Names of those wanted; empty for all.

    Raises:
        MissingDependency: OpenSim is not installed.
    """
    opensim()
    orders = [Order(data, out, name, seed) for name in persons or [one.name for one in PERSONS]]
    with in_parallel() as mapper:
        mapper(make_person, orders)


def make_person(order: Order) -> None:
    """Makes one person under every skin model.

    Args:
        order: Person, places and seed.
    """
    person = person_named(order.person)
    number = PERSONS.index(person)
    body = person.build(order.data)
    names, stand = person.markers(body), standing(person, body)
    motions = {name: movement(name, person, body, order.data) for name in MOVEMENTS}
    places = {name: placed(body, one.motion.q, names) for name, one in motions.items()}
    still = placed(body, stand[None], names)
    rng = np.random.default_rng([order.seed, number])
    away = misplacements(names, rng)
    for k, model in enumerate(MODELS):
        folder = order.out / model / person.name
        folder.mkdir(parents=True, exist_ok=True)
        write_person(folder / "person.json", person, body, stand)
        exact = static_places(still.exact_m[0], rng)
        write_markers(folder / "static_exact.trc", names, exact)
        misplaced = exact + shifted(body, names, still, away)
        write_markers(folder / "static.trc", names, misplaced + NOISE_M * rng.normal(size=exact.shape))
        movements = {name: (one.motion.q, places[name]) for name, one in motions.items()}
        seed, sizing = 1000 * order.seed + 10 * number + k, len(MOVEMENTS) - len(ADDED)
        skins = on_skin(person, body, model, stand, movements, seed, sizing)
        shown = seen(person, names)
        kept = tuple(names[k] for k in shown)
        added = np.random.default_rng([order.seed, number, k])
        for name, one in motions.items():
            draw = added if name in ADDED else rng
            (folder / name).mkdir(exist_ok=True)
            base = places[name].exact_m + shifted(body, names, places[name], away)
            base = base + NOISE_M * draw.normal(size=base.shape)
            write_markers(folder / name / "exact.trc", names, places[name].exact_m)
            write_markers(folder / name / "noskin.trc", kept, base[:, shown])
            write_markers(folder / name / "trial.trc", kept, with_gaps((base + skins[name])[:, shown], draw))
            write_plates(folder / name / "grf.mot", body, one)
            write_truth(folder / name / "truth.npz", body, one)


def movement(name: str, person: Person, body: OsimBody, data: Path) -> Recorded:
    """A movement of a person with its loads.

    Args:
        name: One of :data:`MOVEMENTS`.
        person: The person.
        body: The person's body.
        data: Folder of the reference captures.
    """
    motion = (
        made(name, person, body)
        if name in (*MADE, *ADDED)
        else transferred(person, body, _measured(name, person, data))
    )
    return recorded(body, in_free_flight(body, motion))


def _measured(name: str, person: Person, data: Path) -> Measured:
    source = Foreigner(person.moved_as, data / FOLDER / person.moved_as)
    body = person_named("child").build(data) if person.moved_as == "child" else OsimBody(data / MODEL)
    with np.load(source.folder / name / "truth.npz") as held:
        contacts, floor = np.asarray(held["con"], bool), float(held["floor"])
    return Measured(body, source.truth(name), contacts, floor)
