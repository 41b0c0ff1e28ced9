"""Libraries and public captures that each benchmark needs besides a plain installation, looked for before it starts."""

from __future__ import annotations

import importlib.util
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from mbkf.errors import MbkfError

PAGE = "docs/captures.md"
"""The page that states where each capture is had."""

EXTRAS: Mapping[str, str] = {
    "ahrs": "peers",
    "axe_playwright_python": "test",
    "bids_validator_deno": "bridges",
    "biorbd": "peers",
    "bpy": "bridges",
    "distributed": "cluster",
    "ezc3d": "test",
    "matplotlib": "figures",
    "mujoco": "test",
    "opensim": "peers",
    "playwright": "test",
    "pandas": "test",
    "pybullet": "bridges",
    "pylsl": "lsl",
    "pypdf": "test",
    "pytest": "test",
    "sphinx": "docs",
    "vqf": "peers",
    "xarray": "test",
}
"""Extra of ``pyproject.toml`` that installs a module."""


@dataclass(frozen=True)
class Needs:
    """Libraries and captures of a benchmark.

    Attributes:
        libraries: Modules without which it does not run.
        captures: Folders of public captures below the data folder.
        synthetic: True where it also has rows that need no captures; the others are then left out.
        some_rows: Modules without which it leaves rows out.
    """

    libraries: tuple[str, ...] = ()
    captures: tuple[str, ...] = ()
    synthetic: bool = False
    some_rows: tuple[str, ...] = ()


class Lacking(MbkfError):
    """A benchmark cannot start, since a library or a capture is missing."""


_GAIT = ("biomechzoo_walk_turn", "gait2354_walk", "gaitalytics_walk", "rajagopal_walk_run")
_PLATES = (
    *_GAIT,
    "biobuddy_functional",
    "bmc_walk_run",
    "cgm24_lowerlimb_walk",
    "flywheel_squat",
    "fukuchi_run",
    "grand_challenge_knee",
    "judgement",
    "opencap_s6_walk",
    "rehazenter_walk",
    "start_off_treadmill",
    "stoop_lift_box",
    "synthetic_exact_truth",
)
_MARKED = (
    *_GAIT,
    "autolabel_unlabelled_fullbody",
    "biobuddy_functional",
    "bmc_walk_run",
    "cgm24_lowerlimb_walk",
    "opensim_gappy_walk",
    "rehazenter_walk",
    "stoop_lift_box",
)
_NOISE = (
    *_MARKED,
    "c3d_encodings",
    "flywheel_squat",
    "french_walk_no_pelvis",
    "grand_challenge_knee",
    "opencap_s6_walk",
    "pose2sim_keypoints_balance",
    "start_off_treadmill",
    "synthetic_exact_truth",
)
_STRANGERS = ("foreign_truth", "functional_walk", "jam_walk", "landings", "unipd_walk")
_SENSORS = ("imu_broad", "imu_gaitmap_foot", "imu_opensense_walk")

NEEDS: Mapping[str, Needs] = {
    "angles": Needs(captures=("biomechzoo_walk_turn", "cgm24_lowerlimb_walk")),
    "any_capture": Needs(
        captures=(
            *_MARKED,
            "breaker",
            "flywheel_squat",
            "foreign_truth",
            "fukuchi_run",
            "functional_walk",
            "judgement",
            "opencap_s6_walk",
            "strangers3",
            "synthetic_exact_truth",
        )
    ),
    "app": Needs(("axe_playwright_python", "playwright")),
    "batch": Needs(("distributed",)),
    "bridges": Needs(
        libraries=("xarray",),
        captures=(
            "biomechzoo_walk_turn",
            "flywheel_squat",
            "gait2354_walk",
            "gaitalytics_walk",
            "rajagopal_walk_run",
            "synthetic_exact_truth",
        ),
        some_rows=("bids_validator_deno", "bpy", "ezc3d", "mujoco", "opensim", "pandas", "pybullet"),
    ),
    "clinic": Needs(
        captures=(
            "biobuddy_functional",
            "biomechzoo_walk_turn",
            "cgm24_lowerlimb_walk",
            "flywheel_squat",
            "french_walk_no_pelvis",
            "functional_walk",
            "gait2354_walk",
            "gaitalytics_walk",
            "landings",
            "opensim_gappy_walk",
            "rajagopal_walk_run",
            "rehazenter_walk",
            "unipd_walk",
        ),
        some_rows=("axe_playwright_python", "playwright", "pypdf"),
    ),
    "contact": Needs(captures=_MARKED),
    "double_pendulum": Needs(("matplotlib",)),
    "dynamic": Needs(captures=_GAIT),
    "foreign": Needs(captures=("foreign_truth", "rajagopal_walk_run"), some_rows=("opensim",)),
    "full_body": Needs(("matplotlib",), _GAIT, synthetic=True),
    "house": Needs(("pytest", "sphinx")),
    "inertia": Needs(
        captures=("biomechzoo_walk_turn", "gait2354_walk", "rajagopal_walk_run"), synthetic=True
    ),
    "inertial": Needs(
        ("ahrs", "vqf"),
        (*_SENSORS, "biomechzoo_walk_turn", "imu_qmt_fullbody", "rajagopal_walk_run"),
    ),
    "intervals": Needs(captures=("synthetic_exact_truth",), synthetic=True),
    "labelling": Needs(
        captures=(
            "autolabel_unlabelled_fullbody",
            "biomechzoo_walk_turn",
            "gaitalytics_walk",
            "rajagopal_walk_run",
        )
    ),
    "limbs": Needs(
        captures=(
            "biobuddy_functional",
            "biomechzoo_walk_turn",
            "bmc_walk_run",
            "gait2354_walk",
            "grand_challenge_knee",
            "judgement",
            "opencap_s6_walk",
            "rajagopal_walk_run",
        )
    ),
    "live": Needs(
        ("pylsl",),
        (
            "biomechzoo_walk_turn",
            "gait2354_walk",
            "judgement",
            "opencap_s6_walk",
            "rajagopal_walk_run",
            "rehazenter_walk",
            "synthetic_exact_truth",
        ),
    ),
    "loads": Needs(captures=(*_PLATES, "foreign_truth"), some_rows=("opensim",)),
    "madgwick": Needs(("matplotlib",), ("imu_broad",), synthetic=True),
    "main_job": Needs(captures=(*_GAIT, "opensim_gappy_walk", "synthetic_exact_truth")),
    "misuse": Needs(("playwright", "pylsl")),
    "movement": Needs(captures=(*_NOISE, *_STRANGERS, "fukuchi_run", "judgement", "ric_run")),
    "mutants": Needs(("pytest",)),
    "packages": Needs(some_rows=("mujoco", "playwright")),
    "peers": Needs(
        ("ahrs", "biorbd", "opensim", "vqf"), ("gait2354_walk", "imu_broad", "rajagopal_walk_run")
    ),
    "quality": Needs(captures=(*_NOISE, *_STRANGERS, "cmu_basketball", "ric_run", "two_persons_art")),
    "real_truth": Needs(captures=(*_NOISE, "cmu_basketball", "functional_walk", "fukuchi_run")),
    "robustness": Needs(("pylsl",), _SENSORS, synthetic=True),
    "speed": Needs(
        captures=(
            "foreign_truth",
            "functional_walk",
            "gait2354_walk",
            "rajagopal_walk_run",
            "unipd_walk",
        ),
        synthetic=True,
    ),
    "statics": Needs(
        captures=(
            "biobuddy_functional",
            "biomechzoo_walk_turn",
            "bmc_walk_run",
            "flywheel_squat",
            "foreign_truth",
            "gait2354_walk",
            "jam_walk",
            "judgement",
            "opencap_s6_walk",
            "pose2sim_keypoints_balance",
            "rajagopal_walk_run",
            "rehazenter_walk",
            "stoop_lift_box",
            "unipd_walk",
        )
    ),
    "strangers": Needs(
        captures=(
            *_MARKED,
            "breaker",
            "c3d_encodings",
            "cmu_basketball",
            "flywheel_squat",
            "foreign_truth",
            "french_walk_no_pelvis",
            "fukuchi_run",
            "functional_walk",
            "grand_challenge_knee",
            "imu_broad",
            "jam_walk",
            "judgement",
            "landings",
            "opencap_s6_walk",
            "opensim_gappy_walk",
            "pose2sim_keypoints_balance",
            "rehazenter_walk",
            "ric_run",
            "start_off_treadmill",
            "stoop_lift_box",
            "strangers3",
            "synthetic_exact_truth",
            "two_persons_art",
            "unipd_walk",
        ),
        some_rows=("vqf",),
    ),
    "stride_paper": Needs(("matplotlib",), ("imu_gaitmap_foot",), synthetic=True),
    "verdict": Needs(
        captures=(
            *_PLATES,
            *_STRANGERS,
            "c3d_encodings",
            "opensim_gappy_walk",
            "strangers3",
            "two_persons_art",
        ),
        some_rows=("opensim",),
    ),
}
"""Needs by the benchmark's name; the others run after a plain installation, without captures."""


def needs(name: str) -> Needs:
    """Needs of a benchmark."""
    return NEEDS.get(name, Needs())


def require(name: str, data: Path | None, *, quick: bool = False) -> str:
    """Looks for everything that a benchmark needs.

    Args:
        name: The benchmark.
        data: Folder of the public captures, or None.
        quick: A shorter run, which uses some of the captures only; those that are missing are then only stated.

    Returns:
        One line about captures that are missing and without which the benchmark still runs; empty if all are there.

    Raises:
        Lacking: A library is missing, or captures without which the benchmark does not run.
    """
    wanted = needs(name)
    libraries = [one for one in wanted.libraries if not installed(one)]
    if libraries:
        extras = ",".join(sorted({EXTRAS[one] for one in libraries}))
        raise Lacking(f"{name} needs {', '.join(libraries)}: pip install '.[{extras}]'")
    captures = absent(wanted.captures, data)
    if not captures:
        return ""
    lacks = f"{name} needs captures ({', '.join(captures)}); {PAGE} states where to get them"
    if wanted.synthetic:
        return f"{lacks}; their rows are left out"
    if data is None or not quick or len(captures) == len(wanted.captures):
        raise Lacking(f"{lacks}; then give their folder with --data DIR or MBKF_DATA")
    return f"{lacks}; --quick needs some of them only"


def absent(captures: tuple[str, ...], data: Path | None) -> tuple[str, ...]:
    """Folders of captures that are missing, in alphabetical order; all of them without a data folder."""
    return tuple(sorted(one for one in captures if data is None or not (data / one).is_dir()))


def installed(module: str) -> bool:
    """True where a module can be imported; it is looked for, and not loaded."""
    try:
        return importlib.util.find_spec(module) is not None
    except ImportError:
        return False
