"""Which movement a trial is, recognised from its markers: synthetic motions and public captures, named right or not.

All captures and the synthetic persons 0 to 4 were looked at while limits were set; the synthetic persons 10 to 12, of
our own body and motions, were not.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from benchmarks.checks import Check, Context, information
from mbkf.io.capture import read_capture
from mbkf.io.session import TrialKind
from mbkf.study.survey.movement import kind_of_markers
from mbkf.trial.synth import synthesise

PERSONS = {"chosen on": range(5), "shown on": range(10, 13)}
"""Persons by their part in the choice of limits."""

MADE_PERCENT, PUBLIC_PERCENT = 98.0, 95.0

MOTIONS = {
    "walk": TrialKind.WALK,
    "belt_walk": TrialKind.WALK,
    "split_belt_walk": TrialKind.WALK,
    "turn": TrialKind.TURN,
    "squat": TrialKind.SQUAT,
    "sit_to_stand": TrialKind.SQUAT,
    "jump": TrialKind.JUMP,
    "step_up": TrialKind.STAIRS,
    "one_foot": TrialKind.UNKNOWN,
    "reach": TrialKind.UNKNOWN,
    "rail": TrialKind.UNKNOWN,
    "kneel": TrialKind.UNKNOWN,
    "star_arc": TrialKind.UNKNOWN,
}
"""Kinds that markers alone can show: the seat under a person shows in loads only."""

CAPTURES = {
    "autolabel_unlabelled_fullbody/KneeltoProne01_labelled.c3d": TrialKind.UNKNOWN,
    "autolabel_unlabelled_fullbody/PronetoRun01_labelled.c3d": TrialKind.UNKNOWN,
    "autolabel_unlabelled_fullbody/S09_KneeltoRun02_UNLABELLED.c3d": TrialKind.UNKNOWN,
    "biobuddy_functional/functional_right_knee.c3d": TrialKind.UNKNOWN,
    "biobuddy_functional/static.c3d": TrialKind.STATIC,
    "biomechzoo_walk_turn/HC032A_Static_HC032A01.c3d": TrialKind.STATIC,
    "biomechzoo_walk_turn/HC032A_Straight_HC032A03.c3d": TrialKind.WALK,
    "biomechzoo_walk_turn/HC044A_Static_HC044A01.c3d": TrialKind.STATIC,
    "biomechzoo_walk_turn/HC044A_Straight_HC044A15.c3d": TrialKind.WALK,
    "bmc_walk_run/lower_walk1.trc": TrialKind.WALK,
    "bmc_walk_run/run.trc": TrialKind.RUN,
    "bmc_walk_run/run_static.trc": TrialKind.STATIC,
    "c3d_encodings/Eb015pr.c3d": TrialKind.WALK,
    "cgm24_lowerlimb_walk/CGM24_Walking01.c3d": TrialKind.WALK,
    "flywheel_squat/S1_FlywheelSquat.c3d": TrialKind.SQUAT,
    "flywheel_squat/S1_StandingRef.c3d": TrialKind.STATIC,
    "foreign_truth/adult/run/trial.trc": TrialKind.RUN,
    "foreign_truth/adult/squat/trial.trc": TrialKind.SQUAT,
    "foreign_truth/adult/static.trc": TrialKind.STATIC,
    "foreign_truth/adult/walk/trial.trc": TrialKind.WALK,
    "foreign_truth/child/run/trial.trc": TrialKind.RUN,
    "foreign_truth/child/squat/trial.trc": TrialKind.SQUAT,
    "foreign_truth/child/static.trc": TrialKind.STATIC,
    "foreign_truth/child/walk/trial.trc": TrialKind.WALK,
    "french_walk_no_pelvis/marche281.c3d": TrialKind.WALK,
    "fukuchi_run/RBDS001runT35.c3d": TrialKind.RUN,
    "fukuchi_run/RBDS001static.c3d": TrialKind.STATIC,
    "functional_walk/FunctionalStatic.c3d": TrialKind.STATIC,
    "functional_walk/FunctionalWalk.c3d": TrialKind.WALK,
    "gait2354_walk/subject01_static.trc": TrialKind.STATIC,
    "gait2354_walk/subject01_walk1.trc": TrialKind.WALK,
    "gaitalytics_walk/overground_fullbody_4plates.c3d": TrialKind.WALK,
    "grand_challenge_knee/ss1.trc": TrialKind.WALK,
    "grand_challenge_knee/ss3.trc": TrialKind.WALK,
    "grand_challenge_knee/static.trc": TrialKind.STATIC,
    "jam_walk/static1.trc": TrialKind.STATIC,
    "judgement/walk7_120frames.c3d": TrialKind.WALK,
    "judgement/walk7_static.c3d": TrialKind.STATIC,
    "landings/aStaticTrial.c3d": TrialKind.STATIC,
    "landings/doubleLegLanding.c3d": TrialKind.JUMP,
    "opencap_s6_walk/s6_static1.trc": TrialKind.STATIC,
    "opencap_s6_walk/s6_walking1.trc": TrialKind.WALK,
    "opensim_gappy_walk/walking2.c3d": TrialKind.WALK,
    "pose2sim_keypoints_balance/balancing_filt.trc": TrialKind.UNKNOWN,
    "pose2sim_keypoints_balance/static_filt.trc": TrialKind.STATIC,
    "rajagopal_walk_run/motion_capture_run.trc": TrialKind.RUN,
    "rajagopal_walk_run/motion_capture_walk.trc": TrialKind.WALK,
    "rajagopal_walk_run/static_run.trc": TrialKind.STATIC,
    "rajagopal_walk_run/static_walk_1.trc": TrialKind.STATIC,
    "rajagopal_walk_run/static_walk_2.trc": TrialKind.STATIC,
    "rehazenter_walk/2014001_C1_01.c3d": TrialKind.WALK,
    "rehazenter_walk/2014001_ST_static.c3d": TrialKind.STATIC,
    "ric_run/20140515T133244_run.c3d": TrialKind.RUN,
    "ric_run/20140515T133244_static.c3d": TrialKind.STATIC,
    "start_off_treadmill/markers.trc": TrialKind.UNKNOWN,  # stands astride the belt, then steps onto it sideways
    "stoop_lift_box/stoop1_t169_f620f800.c3d": TrialKind.UNKNOWN,
    "stoop_lift_box/stoop2_t169_f1395f1590.c3d": TrialKind.UNKNOWN,
    "stoop_lift_box/stoop3_t169_f2101f2300.c3d": TrialKind.UNKNOWN,
    "synthetic_exact_truth/subject01_walk2_markers.trc": TrialKind.WALK,
    "unipd_walk/Static1.c3d": TrialKind.STATIC,
    "unipd_walk/Walking1.c3d": TrialKind.WALK,
}


def run(context: Context) -> list[Check]:
    """Shares of movements named right; those named wrong follow with the name that they got."""
    rows: list[Check] = []
    for label, persons in PERSONS.items():
        named = {
            f"{motion} {seed}": (kind, kind_of_markers(synthesise(motion, seed=seed)[1].trial.markers))
            for motion, kind in MOTIONS.items()
            for seed in persons
        }
        rows += _rows(f"synthetic, {label}", named, MADE_PERCENT)
    data = context.require_data()
    public = {name: (kind, _kind(data / name)) for name, kind in CAPTURES.items()}
    return [*rows, *_rows("public, chosen on", public, PUBLIC_PERCENT)]


def _kind(path: Path) -> TrialKind:
    return kind_of_markers(read_capture(path).markers)


def _rows(title: str, named: dict[str, tuple[TrialKind, TrialKind]], percent: float) -> Iterator[Check]:
    right = sum(kind == found for kind, found in named.values())
    yield Check(f"{title}: movements named right", 100.0 * right / len(named), percent, ">=", "%")
    for name, (kind, found) in named.items():
        if kind != found:
            yield information(f"{title}: {name}, {kind.value} named {found.value}", 1.0)
