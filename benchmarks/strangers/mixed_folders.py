"""Mixed folders: captures of two to six persons in one folder, with their own names and with names that state nothing.

Folders are put together from public captures and from persons made by us. The settings that separate persons by their
movements (:mod:`mbkf.study.scaling.owner`) were chosen on the persons of :data:`CHOSEN_ON`; others are those of
:data:`OTHERS`. Captures of a folder whose names state nothing are cut, and state no mass, height
or subject.
"""

from __future__ import annotations

import shutil
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from os import cpu_count
from pathlib import Path

from benchmarks.checks import Check, information
from benchmarks.session.change import marked_anew
from mbkf.io.c3d_write import write_c3d
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture
from mbkf.study.batch.outcome import Status
from mbkf.study.batch.person import record_of
from mbkf.study.batch.plan import Plan, Trial, trial_names
from mbkf.study.batch.run import outcomes_of, plan_of, sorted_plan, with_others
from mbkf.study.batch.workers import LocalWorkers
from mbkf.study.scaling.report import used_trials
from mbkf.synthesis.person import synthesise_subject
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.synth import synthesise

MASS_KG = 70.0
"""Mass that is stated for all: it plays no part in whose a capture is."""

MOST_FRAMES, SECONDS = 60, 2.0
"""Frames of a cut capture, and length of a made walk."""

ANEW = " anew"
"""Ends the name of a person whose markers were put on anew."""

QUICK = ReconstructSettings(filter="kinematic", smooth=False)


@dataclass(frozen=True)
class Files:
    """Captures of a person.

    Attributes:
        folder: Their folder among the data.
        static: The standing trial; empty without one.
        trials: The moving trials.
        beside: Files of ground reactions.
        up: Axis that points up, where the standing trial does not show it.
    """

    folder: str
    static: str
    trials: tuple[str, ...]
    beside: tuple[str, ...] = ()
    up: str | None = None


CHOSEN_ON: Mapping[str, Files] = {
    "HC032A": Files("biomechzoo_walk_turn", "HC032A_Static_HC032A01.c3d", ("HC032A_Straight_HC032A03.c3d",)),
    "HC044A": Files("biomechzoo_walk_turn", "HC044A_Static_HC044A01.c3d", ("HC044A_Straight_HC044A15.c3d",)),
    "functional": Files("functional_walk", "FunctionalStatic.c3d", ("FunctionalWalk.c3d",)),
    "gait2354": Files(
        "gait2354_walk", "subject01_static.trc", ("subject01_walk1.trc",), ("subject01_walk1_grf.mot",)
    ),
    "flywheel": Files("flywheel_squat", "S1_StandingRef.c3d", ("S1_FlywheelSquat.c3d",)),
    "keypoints": Files("pose2sim_keypoints_balance", "static_raw.trc", ("balancing_raw.trc",)),
    "rajagopal walk": Files("rajagopal_walk_run", "static_walk_1.trc", ("motion_capture_walk.trc",)),
    "adult": Files("foreign_truth/adult", "static.trc", ("walk/trial.trc", "squat/trial.trc")),
}
OTHERS: Mapping[str, Files] = {
    "rehazenter": Files("rehazenter_walk", "2014001_ST_static.c3d", ("2014001_C1_01.c3d",)),
    "stoop": Files(
        "stoop_lift_box",
        "neu_t169_f250f350.c3d",
        ("stoop1_t169_f620f800.c3d", "stoop2_t169_f1395f1590.c3d"),
    ),
    "cgm24": Files("cgm24_lowerlimb_walk", "", ("CGM24_Walking01.c3d",)),
    "gaitalytics": Files("gaitalytics_walk", "", ("overground_fullbody_4plates.c3d",)),
    "bmc": Files("bmc_walk_run", "run_static.trc", ("run.trc",), ("run_grf.mot",)),
    "rajagopal run": Files("rajagopal_walk_run", "static_run.trc", ("motion_capture_run.trc",)),
    "child": Files("foreign_truth/child", "static.trc", ("walk/trial.trc", "squat/trial.trc")),
    "landing": Files("landings", "", ("doubleLegLanding.c3d",)),
    "unipd": Files("unipd_walk", "Static1.c3d", ("Walking1.c3d",)),
    "fukuchi": Files("fukuchi_run", "RBDS001static.c3d", ("RBDS001runT35.c3d",)),
    "ric": Files("ric_run", "20140515T133244_static.c3d", ("20140515T133244_run.c3d",), up="y"),
    "opencap": Files("opencap_s6_walk", "s6_static1.trc", ("s6_walking1.trc",)),
    "knee challenge": Files("grand_challenge_knee", "static.trc", ("ss1.trc", "ss3.trc")),
    "biobuddy": Files("biobuddy_functional", "static.c3d", ("functional_right_knee.c3d",)),
    "judgement": Files("judgement", "walk7_static.c3d", ("walk7_120frames.c3d",)),
    "made 20": Files("", "", ()),
    "made 21": Files("", "", ()),
    "made 22": Files("", "", ()),
    "made 24": Files("", "", ()),
    "made 25": Files("", "", ()),
}
"""Public persons, and made ones by their seeds. The bounds of lengths of bones (:mod:`mbkf.trial.checks.persons`) and
of changed distances (:mod:`mbkf.study.scaling.likeness`), on which the settings build, had seen pairs of some of them.
Folders of ric and of the landing failed at first. The axis that points up is given for ric, whose standing trial does
not show it; the standing trial of the landing is left out, since of a marker set of other names it cannot be compared
and stands as another person's."""


@dataclass(frozen=True)
class Folder:
    """A mixed folder.

    Attributes:
        persons: Names of the persons.
        names: "own": files as they are; "static1": standing trials are named, moving ones numbered; "trial1": all are
            numbered; "moving": trials without standing ones; "one static": the standing trial of the first person
            alone; "folders": a folder for each, with the same names in all; "anew": the first person once more, with
            markers put on anew.
    """

    persons: tuple[str, ...]
    names: str

    @property
    def label(self) -> str:
        """The folder in words."""
        return f"{', '.join(self.persons)} ({self.names})"


CHOSEN_FOLDERS = (
    Folder(("HC032A", "HC044A"), "own"),
    Folder(("flywheel", "HC032A", "functional"), "own"),
    Folder(("HC032A", "HC044A"), "static1"),
    Folder(("flywheel", "HC044A"), "static1"),
    Folder(("HC032A", "HC044A", "functional"), "trial1"),
    Folder(("rajagopal walk", "adult"), "static1"),
    Folder(("rajagopal walk", "adult", "gait2354", "HC032A"), "trial1"),
    Folder(("keypoints", "HC044A"), "trial1"),
    Folder(("adult", "rajagopal walk"), "one static"),
    Folder(("HC044A", "HC032A", "functional"), "moving"),
)
OTHER_FOLDERS = (
    Folder(("rehazenter", "stoop"), "own"),
    Folder(("stoop", "unipd", "bmc"), "own"),
    Folder(("fukuchi", "rehazenter"), "own"),
    Folder(("stoop", "gaitalytics"), "static1"),
    Folder(("stoop", "rehazenter", "unipd", "judgement"), "static1"),
    Folder(("bmc", "rajagopal run"), "static1"),
    Folder(("made 20", "made 21"), "static1"),
    Folder(("made 20", "made 21", "made 22", "made 24", "made 25", "judgement"), "static1"),
    Folder(("child", "opencap"), "static1"),
    Folder(("child", "landing", "knee challenge", "stoop", "ric"), "static1"),
    Folder(("biobuddy", "landing"), "static1"),
    Folder(("bmc", "rajagopal run"), "trial1"),
    Folder(("made 20", "made 21", "made 22", "judgement"), "trial1"),
    Folder(("child", "landing", "opencap"), "trial1"),
    Folder(("fukuchi", "ric", "bmc"), "trial1"),
    Folder(("knee challenge", "unipd", "landing", "fukuchi", "bmc", "opencap"), "trial1"),
    Folder(("made 24", "made 25", "judgement"), "moving"),
    Folder(("gaitalytics", "cgm24"), "moving"),
    Folder(("gaitalytics", "cgm24", "stoop"), "moving"),
    Folder(("made 21", "made 22"), "one static"),
    Folder(("made 25", "made 20", "made 24"), "one static"),
    Folder(("stoop", "gaitalytics", "cgm24"), "one static"),
    Folder(("made 20", "child", "stoop"), "folders"),
    Folder(("made 21", "made 22"), "anew"),
    Folder(("made 25",), "anew"),
)


def mixed_folder_rows(data: Path, out: Path) -> list[Check]:
    """Rows of folders of several persons: persons apart, and no body of another person.

    Args:
        data: Folder of the reference captures.
        out: Where to write.
    """
    rows: list[Check] = []
    workers = LocalWorkers(cpu_count() or 1)
    for title, folders in (("chosen on", CHOSEN_FOLDERS), ("other persons", OTHER_FOLDERS)):
        found = [
            _judged(folder, data, out / "mixed" / f"{title[:6]}{n}", workers)
            for n, folder in enumerate(folders)
        ]
        rows += [row for one in found for row in one.remarks()]
        numbers = (
            ("persons in one", sum(len(one.joined) for one in found)),
            ("persons in two", sum(len(one.split) for one in found)),
            ("trials with another person's body", sum(len(one.wrong) for one in found)),
            ("trials refused beside their own standing trial", sum(len(one.refused) for one in found)),
        )
        name = f"{len(found)} mixed folders, {title}"
        rows += [Check(f"{name}: {label}", number, 0.0, "<=") for label, number in numbers]
        rows.append(information(f"{name}: trials done", sum(one.done for one in found)))
    workers.close()
    return rows


@dataclass(frozen=True)
class Judged:
    """A folder after a batch.

    Attributes:
        folder: The folder.
        done: Number of trials that were done.
        joined: Pairs of persons under one name.
        split: Persons under several names.
        wrong: Trials with another person's body.
        refused: Trials that were not done, although a standing trial of their person and session is there.
    """

    folder: Folder
    done: int
    joined: tuple[str, ...]
    split: tuple[str, ...]
    wrong: tuple[str, ...]
    refused: tuple[str, ...]

    def remarks(self) -> Iterator[Check]:
        """A row for each fault."""
        label = self.folder.label
        for word in ("joined", "split", "wrong", "refused"):
            for one in getattr(self, word):
                yield information(f"mixed folder {label}: {word}: {one}", 1.0)


def _judged(folder: Folder, data: Path, place: Path, workers: LocalWorkers) -> Judged:
    """A folder written, run and compared with the truth."""
    shutil.rmtree(place, ignore_errors=True)
    owners = _written(folder, data, place / "study")
    plan = sorted_plan(plan_of(place / "study"), workers)
    trials = [replace(t, person=replace(t.person, mass_kg=t.person.mass_kg or MASS_KG)) for t in plan.trials]
    plan = Plan(tuple(trials), plan.notes)
    asked = place / "out", QUICK, workers
    plan, outcomes = with_others(plan, outcomes_of(plan, *asked), *asked)
    done, failed = {}, {}
    for trial, outcome in zip(plan.trials, outcomes, strict=True):
        if outcome.status == Status.DONE:
            done[trial.path] = (trial.person.name, _body_of(trial, place / "out", owners))
        else:
            failed[trial.path] = outcome.reason
    return compared(folder, owners, done, failed, _may_be_done(folder, data))


def compared(
    folder: Folder,
    owners: Mapping[Path, str],
    done: Mapping[Path, tuple[str, set[str]]],
    failed: Mapping[Path, str],
    possible: Collection[str],
) -> Judged:
    """A batch's results against the truth.

    Args:
        folder: The folder.
        owners: Person of each capture; with " anew" for markers that were put on anew.
        done: By capture, the name of the batch for its person, and the owners of the captures of its body.
        failed: By capture, the reason.
        possible: Owners whose trials can be done.
    """
    persons: dict[str, set[str]] = {}
    for path, (name, _) in done.items():
        persons.setdefault(name, set()).add(owners[path].removesuffix(ANEW))
    names = {one: [name for name, some in persons.items() if one in some] for one in folder.persons}
    return Judged(
        folder,
        len(done),
        tuple(f"{' and '.join(sorted(some))}: {name}" for name, some in persons.items() if len(some) > 1),
        tuple(f"{one}: {' and '.join(given)}" for one, given in names.items() if len(given) > 1),
        tuple(
            f"{path.name}, {owners[path]}" for path, (_, body) in done.items() if not _own(body, owners[path])
        ),
        tuple(f"{path.name}: {reason}" for path, reason in failed.items() if owners[path] in possible),
    )


def _own(body: Collection[str], owner: str) -> bool:
    """True where a body was scaled from captures of one person, the owner of a trial."""
    return {one.removesuffix(ANEW) for one in body} == {owner.removesuffix(ANEW)}


def _may_be_done(folder: Folder, data: Path) -> set[str]:
    """The owners of captures beside a standing trial of theirs, or where nobody has one."""
    if folder.names == "one static":
        return {folder.persons[0]}
    owners = {
        one for one in folder.persons if folder.names == "moving" or _captures(one, data)[0] is not None
    }
    return owners | {f"{folder.persons[0]}{ANEW}"} if folder.names == "anew" else owners


def _body_of(trial: Trial, out: Path, owners: Mapping[Path, str]) -> set[str]:
    """The persons and sessions whose captures a trial's body was scaled from."""
    person = trial.person
    used = used_trials(record_of(out / person.place))
    files = {name: one.path for name, one in trial_names(person.moving).items()}
    files |= {path.stem: path for path in person.statics}
    return {owners[files[name]] for name in used if name in files}


def _written(folder: Folder, data: Path, place: Path) -> dict[Path, str]:
    """Writes a folder; returns the owner of each capture: the person, and "anew" for markers that were put on anew."""
    place.mkdir(parents=True)
    if folder.names == "own":
        return _copied(folder.persons, data, place)
    looks = [(person, *_captures(person, data)) for person in folder.persons]
    if folder.names == "anew":
        first = folder.persons[0]
        looks.append((f"{first}{ANEW}", *_made(int(first.split()[1]), anew=True)))
    owners: dict[Path, str] = {}
    statics = [(person, static) for person, static, _ in looks if static is not None]
    if folder.names in {"moving", "one static"}:
        statics = statics[:1] if folder.names == "one static" else []
    trials = [(person, trial) for person, _, some in looks for trial in some]
    if folder.names == "folders":
        for person, static in statics:
            _write(static, place / person / "static.c3d", owners, person)
        for person, trial in trials:
            _write(trial, place / person / "walk.c3d", owners, person)
        return owners
    if folder.names == "trial1":
        statics, trials = [], _mixed([*statics, *trials])
    for number, (person, static) in enumerate(statics, start=1):
        _write(static, place / f"static{number}.c3d", owners, person)
    for number, (person, trial) in enumerate(_mixed(trials), start=1):
        _write(trial, place / f"trial{number}.c3d", owners, person)
    return owners


def _copied(persons: Sequence[str], data: Path, place: Path) -> dict[Path, str]:
    owners = {}
    for person in persons:
        files = _files(person)
        for name in (*filter(None, [files.static]), *files.trials, *files.beside):
            shutil.copyfile(data / files.folder / name, place / name)
            owners[place / name] = person
    return owners


def _mixed(captures: Sequence[tuple[str, Capture]]) -> list[tuple[str, Capture]]:
    """Captures of the persons in turn."""
    return [*captures[::2], *captures[1::2]]


def _write(capture: Capture, path: Path, owners: dict[Path, str], person: str) -> None:
    path.parent.mkdir(exist_ok=True)
    write_c3d(capture, path)
    owners[path] = person


def _files(person: str) -> Files:
    return CHOSEN_ON[person] if person in CHOSEN_ON else OTHERS[person]


@cache
def _captures(person: str, data: Path) -> tuple[Capture | None, tuple[Capture, ...]]:
    """The standing trial and the moving ones of a person, cut."""
    if person.startswith("made"):
        return _made(int(person.split()[1]))
    files = _files(person)

    def read(name: str) -> Capture:
        return _cut(read_capture(data / files.folder / name, up=files.up))

    return read(files.static) if files.static else None, tuple(map(read, files.trials))


@cache
def _made(seed: int, anew: bool = False) -> tuple[Capture, tuple[Capture, ...]]:
    """The standing trial and a walk of a made person, with markers put on anew where that is asked for."""
    person = synthesise_subject(seed, varied=True)
    worn = marked_anew(person, seed) if anew else person
    _, made = synthesise("walk", seed=seed + (100 if anew else 0), seconds=SECONDS, subject=worn)
    return _cut(made.static), (_cut(made.trial),)


def _cut(capture: Capture) -> Capture:
    """The middle frames of a capture, without plates and statements about its person."""
    markers = capture.markers
    first = max(0, (markers.frames - MOST_FRAMES) // 2)
    few = replace(markers, positions_m=markers.positions_m[first : first + MOST_FRAMES], start_time_s=0.0)
    return Capture(capture.path, few)
