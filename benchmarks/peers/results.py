"""What each tool makes of a capture; every tool has its markers corrected on the trial."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from benchmarks.dynamic.methods import Method, corrected
from benchmarks.peers import biorbd_tool, opensim_ik, opensim_model
from benchmarks.peers.biomod import BiomodBody
from benchmarks.peers.biomod_from_osim import body_of
from benchmarks.peers.biorbd_tool import DEFAULT, Motion, Noise
from benchmarks.peers.required import opensim
from benchmarks.peers.shared import Shared, shared
from mbkf.conventions import Array
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject

ROUNDS = 10
"""How often peers' markers are corrected on a trial; from here on, a round lowers their error by less than 1 %."""

CAUSAL, SMOOTH = Method("dynamic"), Method("dynamic", smooth=True)

NOISES: Mapping[str, Noise] = {"": DEFAULT, ", noise 1e-8": Noise(1e-8)}
"""Noise factors of biorbd: its defaults, and that of the process which suits hidden markers best on these trials."""

TOES = {"": False, ", toes held": True}
"""Peers' bodies with toes that bend, and with toes that are held: a toe with one marker is a burden to both."""


@dataclass(frozen=True)
class PeerBody:
    """A person for the peers, with markers corrected on the whole trial.

    Attributes:
        model: OpenSim's model, a file.
        body: biorbd's body with the shared markers.
    """

    model: Path
    body: BiomodBody


@dataclass(frozen=True)
class Followed:
    """A trial followed by OpenSim: (T, C) coordinates by name, and (T, M, 3) the model's markers, m."""

    coordinates: tuple[str, ...]
    q: Array
    markers_m: Array


@dataclass(frozen=True)
class Results:
    """What the tools make of a capture.

    Attributes:
        shared: The capture.
        subject: mbkf's person with corrected markers.
        causal, smooth: mbkf's dynamic filter.
        bodies: The peers' bodies, by what is done with their toes.
        opensim: OpenSim's motion, by the same.
        biorbd: biorbd's motion, by the same and the noise factors.
    """

    shared: Shared
    subject: Subject
    causal: Reconstruction
    smooth: Reconstruction
    bodies: Mapping[str, PeerBody]
    opensim: Mapping[str, Followed]
    biorbd: Mapping[tuple[str, str], Motion]


def results(name: str, data: Path, folder: Path) -> Results:
    """Runs every tool on a capture.

    Args:
        name: Name of the capture.
        data: Folder of the reference captures.
        folder: Where models are written.
    """
    model = opensim_model.write_model(name, data, folder)
    own = shared(name, data, opensim_model.marker_names(model))
    subject = corrected(own.person.subject, own.person.capture)
    bodies = {
        toes: corrected_body(opensim_model.with_toes_held(model) if held else model, own)
        for toes, held in TOES.items()
    }
    return Results(
        own,
        subject,
        CAUSAL.run(own.person.capture, subject),
        SMOOTH.run(own.person.capture, subject),
        bodies,
        {toes: follow_by_opensim(body, own, own.lab_m) for toes, body in bodies.items()},
        {
            (toes, kind): biorbd_tool.follow(body.body, own.lab_m, own.rate_hz, noise)
            for toes, body in bodies.items()
            for kind, noise in NOISES.items()
        },
    )


def corrected_body(model: Path, own: Shared) -> PeerBody:
    """The peers' bodies of a model, with markers corrected by each tool on the whole trial.

    Args:
        model: OpenSim's model, a file.
        own: The trial.
    """
    read = opensim().Model(str(model))
    opensim_model.correct_markers(read, own.names, own.lab_m, own.times_s, ROUNDS)
    path = model.with_suffix(".corrected.osim")
    read.printToXML(str(path))
    body = biorbd_tool.with_markers(body_of(model), own.names)
    return PeerBody(path, biorbd_tool.correct_markers(body, own.lab_m, own.rate_hz, ROUNDS))


def follow_by_opensim(body: PeerBody, own: Shared, lab_m: Array) -> Followed:
    """OpenSim's inverse kinematics of a trial.

    Args:
        body: The person.
        own: The trial.
        lab_m: (T, M, 3) its markers, NaN where not shown, m.
    """
    model = opensim().Model(str(body.model))
    q, markers = opensim_ik.follow(model, own.names, lab_m, own.times_s)
    return Followed(tuple(one.getName() for one in model.getCoordinateSet()), q, markers)
