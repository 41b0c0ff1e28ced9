"""Marker sets that no protocol was made for: a protocol that knows few of the markers is never used in silence.

Ten mixed sets are made from one standing person, whose markers' places are true whatever their names are. Some names
of one protocol stay, among names and points that it does not know. Where the protocol knows less than 60 % of the
markers, `scale` has to infer the set and to say so, to warn, or to refuse; it has to tell every marker it ignores.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.checks import Check, information
from mbkf.errors import MbkfError
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.model.human import HumanModel
from mbkf.model.protocol import detect_protocol, load_protocol
from mbkf.sensors.contact.soles import sole_points
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.trial.preparation.coverage import INFERRED_KEY, USE_KEY
from mbkf.trial.scale import scale

MASS_KG = 70.0
LEAST_SHARE = 0.6
"""Below this share a protocol may not be used in silence; the program's own bound does not move this one."""

FRAMES, SPREAD_M = 5, 0.0005

FOREIGN = (
    "beak", "neck", "crest", "tail", "r.loin", "l.loin", "R.Knee", "L.Knee", "R.Ankle", "L.Ankle", "R.Heel", "L.Heel",
    "r.claw", "l.claw", "r.spur", "l.spur", "R.Shoulder", "L.Shoulder", "R.Elbow", "L.Elbow", "R.Wrist", "L.Wrist",
)  # fmt: skip
"""Names of a set of which 12 are also names of Helen Hayes markers, which it does not hold otherwise."""


@dataclass(frozen=True)
class MixedSet:
    """A set of markers that mixes names.

    Attributes:
        name: For the row.
        protocol: Where the markers sit, and what some are called.
        kept: How many keep their names: the first of the protocol's.
        strangers: How many others are there under names that no protocol has, on the body and beside it.
        names: Names to use instead of the protocol's; markers whose names they are keep their places.
    """

    name: str
    protocol: str
    kept: int
    strangers: int
    names: tuple[str, ...] = ()


SETS = (
    MixedSet("foreign names", "helen_hayes", 0, 0, FOREIGN),
    MixedSet("foreign names and 42 computed points", "helen_hayes", 0, 42, FOREIGN),
    MixedSet("7 of 51", "plug_in_gait", 7, 44),
    MixedSet("12 of 63", "helen_hayes", 12, 51),
    MixedSet("15 of 30", "reference36", 15, 15),
    MixedSet("20 of 34", "rajagopal_run", 20, 14),
    MixedSet("30 of 60", "autolabel62", 30, 30),
    MixedSet("whole Plug-in Gait among 40 others", "plug_in_gait", 99, 40),
    MixedSet("whole reference set among 30 others", "reference36", 99, 30),
    MixedSet("whole Helen Hayes among 25 others", "helen_hayes", 99, 25),
    MixedSet("whole Plug-in Gait and 5 others", "plug_in_gait", 99, 5),
    MixedSet("20 of 30", "gait2354", 20, 10),
)


def coverage_rows() -> list[Check]:
    """The rows of the table."""
    verdicts = [verdict(mixed(one)) for one in SETS]
    low = [found for found in verdicts if found.share < LEAST_SHARE]
    return [
        Check("coverage: mixed sets below 60 %", len(low), 10, ">="),
        Check("coverage: sets used in silence", sum(v.silent for v in verdicts), 0, "<="),
        Check("coverage: ignored markers not told", sum(v.untold for v in verdicts), 0, "<="),
        Check("coverage: sets above 60 % refused", sum(v.refused for v in verdicts if v not in low), 0, "<="),
        information("coverage: sets refused", sum(v.refused for v in verdicts)),
        information("coverage: sets used with a warning", sum(v.warned for v in verdicts)),
        information("coverage: sets inferred", sum(v.inferred for v in verdicts)),
    ]


@dataclass(frozen=True)
class Verdict:
    """What `scale` did with a set.

    Attributes:
        share: Share of the markers whose names the nearest protocol has.
        refused: Whether it refused the set.
        warned: Whether it scaled with a warning.
        inferred: Whether it inferred a set of its own, and said so.
        untold: Markers that it neither used nor told as ignored.
    """

    share: float
    refused: bool = False
    warned: bool = False
    inferred: bool = False
    untold: int = 0

    @property
    def silent(self) -> bool:
        """Whether too small a share was used without a word."""
        return self.share < LEAST_SHARE and not (self.refused or self.warned or self.inferred)


def verdict(capture: Capture) -> Verdict:
    """Scales a person from a set and looks at what is told.

    Args:
        capture: A standing trial with the set's names.
    """
    names = capture.markers.names
    known = set(detect_protocol(names).match(names))
    share = len(known) / len(names)
    try:
        subject = scale(capture, mass_kg=MASS_KG)
    except MbkfError:
        return Verdict(share, refused=True)
    use = subject.report[USE_KEY]
    assert isinstance(use, dict)
    return Verdict(
        share,
        warned=bool(use["warning"]),
        inferred=INFERRED_KEY in subject.report,
        untold=len(names) - use["used"] - len(use["ignored"]),
    )


def mixed(one: MixedSet) -> Capture:
    """A standing person with the markers of a set.

    Args:
        one: The set.
    """
    rng = np.random.default_rng(len(one.name))
    model = HumanModel.scaled(mass_kg=MASS_KG)
    protocol = load_protocol(one.protocol)
    worn = [marker for marker in protocol.markers if marker.kind != "computed"]
    sensor = MarkerSensor(model, [m.segment for m in worn], np.array([m.position_m for m in worn]))
    pose = model.neutral()
    pose[2] -= sole_points(model, pose[None])[0, :, :, 2].min()
    places = sensor.positions(pose)
    if one.names:
        match = protocol.match(one.names)
        column = {marker.name: i for i, marker in enumerate(worn)}
        on_body = rng.choice(len(worn), len(one.names))
        rows = [column[match[n].name] if n in match else on_body[i] for i, n in enumerate(one.names)]
        named: Sequence[str] = one.names
    else:
        named = [marker.name for marker in worn[: one.kept]]
        rows = list(range(len(named)))
    others = places[rng.choice(len(places), one.strangers)] + rng.uniform(-0.05, 0.05, (one.strangers, 3))
    points = np.vstack([places[rows], others])
    names = (*named, *(f"other{i}" for i in range(one.strangers)))
    positions = points + rng.normal(0.0, SPREAD_M, (FRAMES, *points.shape))
    capture = Capture(f"{one.name}.c3d", MarkerTrajectories(names, positions, 100.0))
    return replace(capture, subject_mass_kg=MASS_KG)
