"""Static trials that are spoilt: public ones, persons made from OpenSim bodies, and synthetic persons."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mbkf.io.capture import read_capture
from mbkf.io.records import MarkerTrajectories
from mbkf.model.human import HumanModel
from mbkf.model.protocol import Protocol, load_protocol
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.synthesis.person import synthesise_subject
from mbkf.trial.axes.captures import checked_for_protocol
from mbkf.trial.preparation.static_names import exchanged_names
from mbkf.trial.protocol.choice import shipped_protocol

CHOSEN = (
    "judgement/walk7_static.c3d",
    "gait2354_walk/subject01_static.trc",
    "flywheel_squat/S1_StandingRef.c3d",
    "rehazenter_walk/2014001_ST_static.c3d",
    "biomechzoo_walk_turn/HC044A_Static_HC044A01.c3d",
    "foreign_truth/adult/static.trc",
    "rajagopal_walk_run/static_run.trc",
    "opencap_s6_walk/s6_static1.trc",
)
SHOWN = (
    "made reference36 3",
    "unipd_walk/Static1.c3d",
    "bmc_walk_run/run_static.trc",
    "rajagopal_walk_run/static_walk_1.trc",
    "rajagopal_walk_run/static_walk_2.trc",
    "jam_walk/static1.trc",
    "biomechzoo_walk_turn/HC032A_Static_HC032A01.c3d",
    "pose2sim_keypoints_balance/static_raw.trc",
    "pose2sim_keypoints_balance/static_filt_LSTM.trc",
    "foreign_truth/child/static.trc",
    "biobuddy_functional/static.c3d",
    "stoop_lift_box/neu_t169_f250f350.c3d",
    "made plug_in_gait 4",
    "made rajagopal_walk 5",
)
"""Files below the folder of reference captures; ``made PROTOCOL SEED`` is a synthetic person."""

EXCHANGED = {
    "gait2354_walk/subject01_static.trc": (("R.Wrist.Med", "R.Wrist.Lat"), ("L.Wrist.Med", "L.Wrist.Lat")),
}
"""Names that a public file itself exchanges, put right before it is spoilt."""

BENT_SD_RAD, PLACED_SD_M = np.deg2rad(4.0), 0.004
"""Spread of a made person's joints about neutral, and of the markers about their places."""


@dataclass(frozen=True)
class Static:
    """A static trial.

    Attributes:
        data: Folder of the reference captures.
        name: Its file below that, or ``made PROTOCOL SEED``.
    """

    data: Path
    name: str

    def load(self) -> tuple[MarkerTrajectories, Protocol]:
        """Its markers in the protocol's axes, and the protocol."""
        if self.name.startswith("made "):
            _, protocol, seed = self.name.split()
            return made(protocol, int(seed)), load_protocol(protocol)
        capture = read_capture(self.data / self.name)
        found = shipped_protocol((capture,))
        assert found is not None
        markers = checked_for_protocol((capture,), found)[0].markers
        return exchanged_names(markers, EXCHANGED.get(self.name, ())), found


def made(protocol: str, seed: int) -> MarkerTrajectories:
    """A synthetic person who stands nearly straight.

    Args:
        protocol: The markers worn.
        seed: Chooses the person.
    """
    rng, person = np.random.default_rng(seed), synthesise_subject(seed, protocol)
    model = HumanModel.of(person)
    places = np.array([marker.position_m for marker in person.markers])
    sensor = MarkerSensor(model, [marker.segment for marker in person.markers], places)
    step = BENT_SD_RAD * rng.standard_normal(model.nv)
    step[:6] = 0.0
    shown = sensor.positions(model.integrate(model.neutral(), step))
    shown = shown + PLACED_SD_M * rng.standard_normal(shown.shape)
    return MarkerTrajectories(tuple(marker.name for marker in person.markers), shown[None], 100.0)


def with_order(markers: MarkerTrajectories, columns: list[int], order: list[int]) -> MarkerTrajectories:
    """The trajectories with those of some columns in another order.

    Args:
        markers: The trajectories.
        columns: The columns.
        order: Which of them each takes.
    """
    places = markers.positions_m.copy()
    places[:, columns] = markers.positions_m[:, [columns[k] for k in order]]
    return replace(markers, positions_m=places)
