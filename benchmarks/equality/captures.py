"""The captures two trees are compared on: how each is prepared, scaled and followed.

A word of a command may hold ``{data}``, the folder of reference captures, and ``{made}``, the folder of
what the capture's own preparation wrote.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

from mbkf.synthesis.motions import motion_names

Mode = Literal["plain", "smoothed", "live"]

FILTERS = ("kinematic", "torque", "dynamic")
MODES: tuple[Mode, ...] = ("plain", "smoothed", "live")
OFFLINE: tuple[Mode, ...] = ("plain", "smoothed")

SUBJECT = "{made}/subject.toml"


@dataclass(frozen=True)
class Run:
    """One way to follow a capture."""

    filter: str
    mode: Mode

    @property
    def name(self) -> str:
        """Name of its folder."""
        return f"{self.filter}-{self.mode}"


@dataclass(frozen=True)
class Captured:
    """A capture that both trees follow.

    Attributes:
        name: Its row and its folder.
        trial: The capture.
        prepare: Commands that write into ``{made}``, in this order; one of them writes the subject.
        options: What both ``mbkf reconstruct`` and ``mbkf live`` need to read the trial.
        extra: What ``mbkf reconstruct`` needs beyond that.
        filters: The filters it is followed with.
        modes: Whether causal, smoothed, live.
        question: What follows ``mbkf`` where another command than reconstruct or live is compared.
    """

    name: str
    trial: str
    prepare: tuple[tuple[str, ...], ...]
    options: tuple[str, ...] = ()
    extra: tuple[str, ...] = ()
    filters: tuple[str, ...] = FILTERS
    modes: tuple[Mode, ...] = MODES
    question: tuple[str, ...] = ()

    @property
    def runs(self) -> tuple[Run, ...]:
        """All combinations of filter and mode."""
        return tuple(Run(name, mode) for name in self.filters for mode in self.modes)

    def words(self, run: Run) -> tuple[str, ...]:
        """What follows ``mbkf`` for a run, without ``--out``."""
        if self.question:
            return self.question
        subject = ("--subject", SUBJECT, "--filter", run.filter)
        if run.mode == "live":
            return ("live", "--from", f"file:{self.trial}", "--speed", "0", *subject, *self.options)
        later = ("--smooth",) if run.mode == "smoothed" else ("--lag", "0")  # older trees know no --causal
        return ("reconstruct", self.trial, *subject, *later, *self.options, *self.extra)


def scaled(
    mass_kg: float, static: str | None = None, trial: str | None = None, protocol: str | None = None
) -> tuple[str, ...]:
    """The command that scales a person from a standing trial or, where there is none, from a moving one.

    Args:
        mass_kg: The person's mass.
        static: Standing trial below the data folder.
        trial: Moving trial below the data folder.
        protocol: Marker protocol, where it knows too few of the markers to be taken unasked.
    """
    source = () if static is None else (f"{{data}}/{static}",)
    moving = () if trial is None else ("--trial", f"{{data}}/{trial}")
    named = () if protocol is None else ("--protocol", protocol)
    return ("scale", *source, *moving, *named, "--mass", str(mass_kg), "--out", SUBJECT)


def with_static(
    name: str, trial: str, static: str, mass_kg: float, forces: str | None = None, protocol: str | None = None
) -> Captured:
    """A capture whose person is scaled from a standing trial.

    Args:
        name: The capture's row.
        trial: Its file below the data folder.
        static: The standing trial, below the data folder.
        mass_kg: The person's mass.
        forces: Ground reactions in a file of their own, below the data folder.
        protocol: Marker protocol, where it knows too few of the markers to be taken unasked.
    """
    options = () if forces is None else ("--forces", f"{{data}}/{forces}")
    return Captured(name, f"{{data}}/{trial}", (scaled(mass_kg, static, protocol=protocol),), options)


def by_itself(
    name: str, trial: str, mass_kg: float, forces: str | None = None, protocol: str | None = None
) -> Captured:
    """A capture whose person is scaled from the same trial, because no standing trial exists.

    Args:
        name: The capture's row.
        trial: Its file below the data folder.
        mass_kg: The person's mass; where the data do not state it, any plausible one.
        forces: Ground reactions in a file of their own, below the data folder.
        protocol: Marker protocol, where it knows too few of the markers to be taken unasked.
    """
    options = () if forces is None else ("--forces", f"{{data}}/{forces}")
    return Captured(name, f"{{data}}/{trial}", (scaled(mass_kg, trial=trial, protocol=protocol),), options)


def synthetic(motion: str) -> Captured:
    """A synthetic motion followed on its own body; the body scaled from its standing trial is compared too."""
    make = ("synth", "--motion", motion, "--out", "{made}")
    scale = ("scale", "{made}/static.c3d", "--mass", "70", "--out", "{made}/scaled.toml")
    return Captured(f"synth_{motion}", "{made}/trial.c3d", (make, scale))


_RAJAGOPAL, _ZOO, _STOOP, _POSE = (
    "rajagopal_walk_run",
    "biomechzoo_walk_turn",
    "stoop_lift_box",
    "pose2sim_keypoints_balance",
)
_AUTOLABEL, _ENCODINGS = "autolabel_unlabelled_fullbody", "c3d_encodings"

_RAJAGOPAL_WALK = with_static(
    "rajagopal_walk",
    f"{_RAJAGOPAL}/motion_capture_walk.trc",
    f"{_RAJAGOPAL}/static_walk_1.trc",
    85.07,
    f"{_RAJAGOPAL}/grf_walk.mot",
)
_GAITALYTICS = by_itself("gaitalytics", "gaitalytics_walk/overground_fullbody_4plates.c3d", 63.6)

_REAL = (
    _RAJAGOPAL_WALK,
    with_static(
        "rajagopal_run",
        f"{_RAJAGOPAL}/motion_capture_run.trc",
        f"{_RAJAGOPAL}/static_run.trc",
        72.84,
        f"{_RAJAGOPAL}/grf_run.mot",
    ),
    with_static(
        "gait2354_walk",
        "gait2354_walk/subject01_walk1.trc",
        "gait2354_walk/subject01_static.trc",
        72.6,
        "gait2354_walk/subject01_walk1_grf.mot",
    ),
    with_static(
        "biomechzoo_HC032A",
        f"{_ZOO}/HC032A_Straight_HC032A03.c3d",
        f"{_ZOO}/HC032A_Static_HC032A01.c3d",
        60.3,
    ),
    with_static(
        "biomechzoo_HC044A",
        f"{_ZOO}/HC044A_Straight_HC044A15.c3d",
        f"{_ZOO}/HC044A_Static_HC044A01.c3d",
        39.4,
    ),
    _GAITALYTICS,
    by_itself("opensim_walking2", "opensim_gappy_walk/walking2.c3d", 75.0),
    by_itself(
        "exact_truth_walk2",
        "synthetic_exact_truth/subject01_walk2_markers.trc",
        72.84,
        "synthetic_exact_truth/subject01_walk2_grf.mot",
    ),
    with_static(
        "bmc_run", "bmc_walk_run/run.trc", "bmc_walk_run/run_static.trc", 70.0, "bmc_walk_run/run_grf.mot"
    ),
    by_itself("bmc_lower_walk1", "bmc_walk_run/lower_walk1.trc", 70.0, protocol="helen_hayes"),
    by_itself("cgm24_walk", "cgm24_lowerlimb_walk/CGM24_Walking01.c3d", 77.6, protocol="plug_in_gait"),
    *(
        with_static(
            f"stoop_lift_{number}", f"{_STOOP}/{trial}", f"{_STOOP}/neu_t169_f250f350.c3d", mass_kg=81.7
        )
        for number, trial in enumerate(
            (
                "stoop1_t169_f620f800.c3d",
                "stoop2_t169_f1395f1590.c3d",
                "stoop3_t169_f2101f2300.c3d",
            ),
            start=1,
        )
    ),
    *(
        with_static(
            f"pose2sim_{kind}",
            f"{_POSE}/balancing_{kind}.trc",
            f"{_POSE}/static_{kind}.trc",
            mass_kg=69.0,
            protocol="helen_hayes",
        )
        for kind in ("raw", "filt", "filt_LSTM")
    ),
    by_itself("kneel_to_prone", f"{_AUTOLABEL}/KneeltoProne01_labelled.c3d", 75.0),
    by_itself("prone_to_run", f"{_AUTOLABEL}/PronetoRun01_labelled.c3d", 75.0),
    Captured(
        "kneel_to_run",
        "{made}/subject.c3d",
        (
            (
                "label",
                f"{{data}}/{_AUTOLABEL}/S09_KneeltoRun02_UNLABELLED.c3d",
                *("--protocol", "autolabel62", "--mass", "75", "--out", "{made}/subject.c3d"),
            ),
        ),
    ),
    with_static("ric_run", "ric_run/20140515T133244_run.c3d", "ric_run/20140515T133244_static.c3d", 70.0),
    with_static(
        "functional_walk", "functional_walk/FunctionalWalk.c3d", "functional_walk/FunctionalStatic.c3d", 60.0
    ),
    replace(  # half a minute at 150 Hz
        with_static("fukuchi_run", "fukuchi_run/RBDS001runT35.c3d", "fukuchi_run/RBDS001static.c3d", 60.3),
        filters=("dynamic",),
        modes=("smoothed",),
    ),
    by_itself("start_off_treadmill", "start_off_treadmill/markers.trc", 70.0, "start_off_treadmill/grf.mot"),
    with_static("landings", "landings/doubleLegLanding.c3d", "landings/aStaticTrial.c3d", 70.0),
    by_itself("french_walk", "french_walk_no_pelvis/marche281.c3d", 69.0),
    with_static("unipd_walk", "unipd_walk/Walking1.c3d", "unipd_walk/Static1.c3d", 70.0),
    with_static(
        "flywheel_squat", "flywheel_squat/S1_FlywheelSquat.c3d", "flywheel_squat/S1_StandingRef.c3d", 75.0
    ),
    by_itself("cmu_basketball", "cmu_basketball/cmu_dribble_shoot_basketball.c3d", 75.0),
    with_static(
        "jam_walk",
        "jam_walk/overground_17.trc",
        "jam_walk/static1.trc",
        70.0,
        "jam_walk/overground_17_grf.mot",
    ),
    with_static(
        "opencap_s6",
        "opencap_s6_walk/s6_walking1.trc",
        "opencap_s6_walk/s6_static1.trc",
        59.0,
        "opencap_s6_walk/s6_walking1_forces.mot",
    ),
    with_static(
        "rehazenter", "rehazenter_walk/2014001_C1_01.c3d", "rehazenter_walk/2014001_ST_static.c3d", 70.0
    ),
    with_static(
        "biobuddy", "biobuddy_functional/functional_right_knee.c3d", "biobuddy_functional/static.c3d", 70.0
    ),
    with_static(
        "knee_challenge",
        "grand_challenge_knee/ss1.trc",
        "grand_challenge_knee/static.trc",
        75.0,
        "grand_challenge_knee/ss1_grf.mot",
    ),
    by_itself("two_persons", "two_persons_art/ART-Human_2persons_integer.c3d", 70.0),
    *(
        with_static(
            f"foreign_{person}_{motion}",
            f"foreign_truth/{person}/{motion}/trial.trc",
            f"foreign_truth/{person}/static.trc",
            mass_kg,
            f"foreign_truth/{person}/{motion}/grf.mot",
        )
        for person, mass_kg in (("adult", 85.3), ("child", 23.0))
        for motion in ("walk", "squat", "run")
    ),
    by_itself("c3d_Eb015pr", f"{_ENCODINGS}/Eb015pr.c3d", 70.0, protocol="opensim_fullbody2009"),
    *(
        # The same trial in other encodings: one filter says whether it is read alike.
        Captured(
            f"c3d_{name}",
            f"{{data}}/{_ENCODINGS}/{name}.c3d",
            (scaled(70.0, trial=f"{_ENCODINGS}/{name}.c3d", protocol="opensim_fullbody2009"),),
            filters=("kinematic",),
            modes=("plain",),
        )
        for name in ("Eb015pi", "Eb015vr", "Eb015vi", "Eb015sr", "Eb015si")
    ),
)


def _walk_with_imus(name: str, *extra: str) -> Captured:
    """The Rajagopal walk with virtual inertial sensors on the motion reconstructed from it."""
    prepare = (
        *_RAJAGOPAL_WALK.prepare,
        (*_RAJAGOPAL_WALK.words(Run("dynamic", "plain")), "--out", "{made}/motion"),
        ("imu", "synth", "{made}/motion/motion.h5", "--out", "{made}/imus.csv"),
    )
    return Captured(
        name,
        _RAJAGOPAL_WALK.trial,
        prepare,
        _RAJAGOPAL_WALK.options,
        ("--imu", "{made}/imus.csv", *extra),
        ("dynamic",),
        OFFLINE,
    )


_OPTIONS = (
    _walk_with_imus("rajagopal_walk_imus"),
    _walk_with_imus("rajagopal_walk_imus_mounts", "--imu-mounts", "{made}/imus.toml"),
    Captured(
        "rajagopal_walk_withheld",
        _RAJAGOPAL_WALK.trial,
        _RAJAGOPAL_WALK.prepare,
        _RAJAGOPAL_WALK.options,
        ("--hide", "R.Knee,R.SH1,R.SH2@0.5:0.8", "--without-plate", "1"),
        modes=OFFLINE,
    ),
    Captured(
        "gaitalytics_keep_markers",
        _GAITALYTICS.trial,
        _GAITALYTICS.prepare,
        extra=("--keep-markers",),
        modes=OFFLINE,
    ),
    *(
        Captured(
            f"rajagopal_walk_{preset}",
            _RAJAGOPAL_WALK.trial,
            _RAJAGOPAL_WALK.prepare,
            (*_RAJAGOPAL_WALK.options, "--preset", preset),
            filters=("torque",),
            modes=("plain",),
        )
        for preset in ("FD", "FDMC", "FD-literal", "FDMC-literal")
    ),
)


def _asked(name: str, *question: str, prepare: tuple[tuple[str, ...], ...] = ()) -> Captured:
    """Another question about a capture than that of its motion by markers."""
    return Captured(name, "", prepare, filters=("asked",), modes=("plain",), question=question)


_SENSORS = (
    ("synth", "--motion", "walk", "--seconds", "4", "--out", "{made}"),
    ("imu", "synth", "{made}/truth.h5", "--out", "{made}/walk.csv"),
)
_INERTIAL = (
    *(
        _asked(
            f"imu_motion_{mode.strip('-') or 'smoothed'}",
            *("imu", "motion", "{made}/walk.csv", "--subject", "{made}/subject.toml", "--standing", "0:0.6"),
            *((mode,) if mode else ()),
            prepare=_SENSORS,
        )
        for mode in ("", "--causal")
    ),
    _asked(
        "imu_angles_opensense",
        *("imu", "angles", "{data}/imu_opensense_walk", "--from-file", "--standing", "0:0.5"),
    ),
    _asked(
        "imu_orient_broad",
        *("imu", "orient", "{data}/imu_broad/11_undisturbed_slow_translation_B.mat", "--frame", "ENU"),
        *("--filter", "ekf"),
    ),
    _asked("imu_stride_gaitmap", "imu", "stride", "{data}/imu_gaitmap_foot/imu_sample.csv"),
)

LONG_MOTIONS = {"star_arc"}
"""Motions of half a minute."""
MOTIONS = tuple(name for name in motion_names(installed=False) if name not in LONG_MOTIONS)

CAPTURES: tuple[Captured, ...] = (*_REAL, *(synthetic(m) for m in MOTIONS), *_OPTIONS, *_INERTIAL)

LEFT_OUT = {
    "csu_2d_id_reference": "a table of six markers in a plane, no capture file",
    "breaker": "damaged files",
    "judgement": "persons and names that are wrong on purpose",
    "strangers3": "excerpts of files, for readers",
    "imu_qmt_fullbody": "inertial sensors, no markers",
}
"""Folders of the data whose captures ``mbkf reconstruct`` cannot follow, each with the reason."""
