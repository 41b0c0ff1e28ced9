"""The benchmark's trials: public captures, persons made from OpenSim's bodies and from ours, clean and with a fault."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from benchmarks.contact.strangers import LIFTER_KG, LIFTS, STANDING, lift
from benchmarks.dynamic.captures import SOURCES, Source
from benchmarks.dynamic.methods import tared
from benchmarks.foreign.making.persons import CHOSEN_ON, SHOWN_ON
from benchmarks.foreign.making.skin import MODELS
from benchmarks.foreign.truth import FOLDER, Foreigner
from benchmarks.loads.faults import Beside, Clock, Fault, Load, Mass
from mbkf.conventions import Array
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.trial.scale import scale
from mbkf.trial.synth import synthesise

MORE_SOURCES: Mapping[str, Source] = {
    "HC032A static": Source(
        "biomechzoo_walk_turn", "HC032A_Static_HC032A01.c3d", 60.3, "HC032A_Static_HC032A01.c3d"
    ),
    "HC044A static": Source(
        "biomechzoo_walk_turn", "HC044A_Static_HC044A01.c3d", 39.4, "HC044A_Static_HC044A01.c3d"
    ),
    "rehazenter": Source("rehazenter_walk", "2014001_C1_01.c3d", 67.0, "2014001_ST_static.c3d"),
    "bmc run": Source("bmc_walk_run", "run.trc", 70.0, None, "run_grf.mot"),
    "cgm24": Source("cgm24_lowerlimb_walk", "CGM24_Walking01.c3d", 77.6),
    "biobuddy": Source("biobuddy_functional", "functional_right_knee.c3d", 62.2),
    "flywheel, standing": Source("flywheel_squat", "S1_StandingRef.c3d", 81.9, "S1_StandingRef.c3d"),
    "fukuchi run": Source("fukuchi_run", "RBDS001runT35.c3d", 60.3, "RBDS001static.c3d"),
    "knee challenge 1": Source("grand_challenge_knee", "ss1.trc", 82.7, "static.trc", "ss1_grf.mot"),
    "knee challenge 3": Source("grand_challenge_knee", "ss3.trc", 82.7, "static.trc", "ss3_grf.mot"),
    "opencap": Source("opencap_s6_walk", "s6_walking1.trc", 59.0, "s6_static1.trc", "s6_walking1_forces.mot"),
    "start off treadmill": Source("start_off_treadmill", "markers.trc", 63.3, None, "grf.mot"),
    "exact truth": Source(
        "synthetic_exact_truth", "subject01_walk2_markers.trc", 72.84, None, "subject01_walk2_grf.mot"
    ),
    "judgement walk": Source("judgement", "walk7_120frames.c3d", 71.86, "walk7_static.c3d"),
}
FLYWHEEL = Source("flywheel_squat", "S1_FlywheelSquat.c3d", 81.9, "S1_StandingRef.c3d")
ALL_SOURCES: Mapping[str, Source] = {**SOURCES, **MORE_SOURCES, "flywheel": FLYWHEEL}
"""Public captures with plates whose mass is known; the flywheel's pull no plate reads."""

SHARED = tuple((person, motion) for person in ("adult", "child") for motion in ("walk", "squat", "run"))
OWN_CLEAN = tuple(
    (motion, seed) for motion in ("walk", "jump", "step_up", "turn", "squat") for seed in (1, 2)
)
MADE_MOTIONS = ("walk", "squat", "run", "sit_to_stand", "stairs", "reach")
MADE_MODEL = MODELS[0]
MADE_LEFT_OUT = ("adult", "child")
"""Made persons with the bodies of the shared ones."""


@dataclass(frozen=True)
class Trial:
    """A trial, clean or with a fault.

    Attributes:
        kind: "real", "lift", "foreign" or "own".
        name: A key of :data:`ALL_SOURCES` or of the lifts, or the motion.
        folder: The data folder, or the person's.
        seed: Of a trial of our own.
        fault: Its fault; None for a clean trial.
        feet_only: Assume that only the feet bear load, so that what else bears is not looked for.
    """

    kind: str
    name: str
    folder: Path
    seed: int = 0
    fault: Fault | None = None
    feet_only: bool = False

    @property
    def label(self) -> str:
        """Name in rows."""
        who = (
            f" of {self.folder.name}"
            if self.kind == "foreign"
            else f" {self.seed}"
            if self.kind == "own"
            else ""
        )
        fault = "" if self.fault is None else f", {self.fault.label}"
        return f"{self.name}{who}{fault}" + (", feet only" if self.feet_only else "")

    def load(self) -> tuple[Capture, Subject, Array | None]:
        """Capture, person, and the (T, 3) force on the body that nothing reads, N; None where it is not known."""
        capture, subject, unread = self._clean()
        if self.fault is None:
            return capture, subject, unread
        return self.fault.put_into(capture, subject)

    def _clean(self) -> tuple[Capture, Subject, Array | None]:
        if self.kind == "real":
            return *_real(ALL_SOURCES[self.name], self.folder), None
        if self.kind == "lift":
            folder = self.folder / "stoop_lift_box"
            trial, load_n = lift(folder, f"{self.name}_{LIFTS[self.name]}")
            down = load_n[: len(trial.markers.times_s), None] * [0.0, 0.0, -1.0]
            return trial, scale(read_capture(folder / STANDING), mass_kg=LIFTER_KG), down
        if self.kind == "foreign":
            person = Foreigner(self.folder.name, self.folder)
            return person.trial(self.name), scale(person.static(), mass_kg=person.mass_kg), None
        subject, made = synthesise(self.name, seed=self.seed)
        unread = made.truth.support_wrench[..., :3].sum(axis=1) if self.feet_only else None
        return tared(made.trial), subject, unread


def _real(source: Source, data: Path) -> tuple[Capture, Subject]:
    folder = data / source.folder
    capture = read_capture(folder / source.trial, forces=source.forces and folder / source.forces)
    static = None if source.static is None else read_capture(folder / source.static)
    return capture, scale(static, [capture] if static is None else [], mass_kg=source.mass_kg)


def clean_trials(data: Path, made: Path | None, quick: bool = False) -> list[Trial]:
    """Clean trials, sixty with persons of our own.

    Args:
        data: Folder of the reference captures.
        made: Folder of persons of our own; None without them.
        quick: Four of them.
    """
    found = [Trial("real", name, data) for name in ALL_SOURCES if name != "flywheel"]
    found += [Trial("foreign", motion, data / FOLDER / person) for person, motion in SHARED]
    found += [Trial("own", motion, data, seed) for motion, seed in OWN_CLEAN]
    if made is not None:
        persons = [one for one in (*CHOSEN_ON, *SHOWN_ON) if one not in MADE_LEFT_OUT]
        every = [(person, motion) for motion in MADE_MOTIONS for person in persons]
        found += [Trial("foreign", motion, made / MADE_MODEL / person) for person, motion in every]
    return found[:: len(found) // 4] if quick else found[:60]


def violators(data: Path, quick: bool = False) -> list[Trial]:
    """Forty trials with a fault or a load that nothing reads.

    Args:
        data: Folder of the reference captures.
        quick: Every fifth of them.
    """
    found = list(_violators(data))
    return found[::5] if quick else found


def _violators(data: Path) -> Iterator[Trial]:
    adult, child = (data / FOLDER / person for person in ("adult", "child"))
    yield Trial("real", "flywheel", data)
    for name in LIFTS:
        yield Trial("lift", name, data, feet_only=True)
    for motion, seeds in (("sit_to_stand", (0, 2, 3)), ("rail", (0, 3))):
        for seed in seeds:
            yield Trial("own", motion, data, seed, feet_only=True)
    walk, gait, standing = (
        Trial("real", name, data) for name in ("rajagopal walk", "gait2354", "HC032A static")
    )
    run, exact = (Trial("real", name, data) for name in ("rajagopal run", "exact truth"))
    adults = {motion: Trial("foreign", motion, adult) for motion in ("walk", "squat", "run")}
    childs = {motion: Trial("foreign", motion, child) for motion in ("walk", "squat", "run")}
    squat, jump = Trial("own", "squat", data, 1), Trial("own", "jump", data, 1)
    faults: list[tuple[Fault, tuple[Trial, ...]]] = [
        (Mass(1.1), (walk, gait, standing, adults["squat"], childs["run"], squat)),
        (Mass(0.9), (run, exact, standing, adults["walk"], childs["squat"], squat)),
        (Clock(0.1), (jump, adults["run"], childs["run"])),
        (Clock(-0.1), (jump, run, childs["run"])),
        (Beside(0.5), (walk, gait, exact, adults["walk"], childs["walk"])),
        (Load("harness", 0.25, (0.3, 1.0)), (adults["walk"], exact, adults["squat"], childs["squat"])),
        (Load("box", -0.15, (0.3, 0.8)), (adults["squat"], childs["squat"], squat)),
        (Load("chair", 0.8, (0.4, 0.7)), (adults["squat"], squat)),
    ]
    for fault, trials in faults:
        for one in trials:
            yield replace(one, fault=fault)
