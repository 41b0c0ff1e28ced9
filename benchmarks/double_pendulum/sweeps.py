"""How errors depend on covariances (thesis figures 3.12–3.15) and on which sensors there are (thesis 3.3.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.double_pendulum.kinematic import KinematicMethod
from benchmarks.double_pendulum.laboratory import FEW_SEEDS, Laboratory, Pair
from benchmarks.double_pendulum.thesis import FD, STUDY, STUDY_RECIPE
from benchmarks.double_pendulum.torque import SENSORS, STANDARD_SENSORS, TorqueMethod
from benchmarks.double_pendulum.trials import Method, Recipe, Scores
from benchmarks.thesis_report.contents import Band, Claim, Findings, Sheet, judged
from mbkf.conventions import Array

EFFORT_NOISES = (100.0, 200.0, 300.0, 500.0, 800.0, 1300.0, 2000.0, 5000.0)
ACCELERATIONS = (0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0)
"""σ_P of the dynamic filter and σ_a of FCDI that are tried."""

QUICK_STEP = 2
"""Of these values a quick run tries one in two."""

RESIDUALS = (None, 1e-3, 1.0, 10.0, 100.0, 1000.0)


@dataclass(frozen=True)
class Sweep:
    """Scores (one entry per seed) at some ``values`` of a covariance."""

    values: Array
    scores: Sequence[Scores]

    def mean(self, name: str) -> Array:
        """Mean over seeds of a score, by value."""
        return np.array([getattr(one, name).mean() for one in self.scores])

    def quantiles(self, name: str, *shares: float) -> Array:
        """(len(shares), values) of a score over seeds; a breakdown of the filter is infinite."""
        return np.stack(
            [np.quantile(getattr(one, name), shares, method="nearest") for one in self.scores], axis=1
        )

    @property
    def best(self) -> float:
        """The value of the least mean torque error: the vertex of a parabola in log σ through the least three."""
        errors, logs = self.mean("torque"), np.log(self.values)
        k = int(np.clip(np.argmin(errors), 1, len(errors) - 2))
        a, b, _ = np.polyfit(logs[k - 1 : k + 2], errors[k - 1 : k + 2], 2)
        return float(np.exp(-0.5 * b / a))


@dataclass(frozen=True)
class Sweeps:
    """Every sweep by motion: of σ_a for ``kinematic``, of σ_P for ``dynamic``."""

    kinematic: dict[str, Sweep]
    dynamic: dict[str, Sweep]


def measure_sweeps(lab: Laboratory) -> Sweeps:
    """Both motions, both filters."""
    every = QUICK_STEP if lab.quick else 1
    accelerations, noises = (values[every - 1 :: every] for values in (ACCELERATIONS, EFFORT_NOISES))
    motions = ("sin", "squat")
    methods: dict[str, list[Method]] = {
        "kinematic": [KinematicMethod(STUDY, value) for value in accelerations],
        "dynamic": [with_noise(value) for value in noises],
    }
    groups = [
        [Pair(Recipe(motion, STUDY), one) for one in family]
        for family in methods.values()
        for motion in motions
    ]
    found = iter(lab.measure_groups("Covariance sweeps", groups))
    kinematic, dynamic = (
        {motion: Sweep(np.array(values), next(found)) for motion in motions}
        for values in (accelerations, noises)
    )
    return Sweeps(kinematic, dynamic)


def with_noise(effort_noise: float) -> TorqueMethod:
    """FD with another σ_P."""
    return replace(FD, settings=replace(FD.settings, effort_noise=effort_noise))


def sweep_findings(sweeps: Sweeps) -> Findings:
    """Where the best covariance lies, and the shape of the curves."""
    bounds = {"sin": (500.0, 2000.0), "squat": (300.0, 1000.0)}
    best = {motion: sweeps.dynamic[motion].best for motion in bounds}
    rows = [Band("best σ_P of FD", motion, best[motion], *bounds[motion], "N m/√s") for motion in bounds]
    sheets = []
    for name, unit, family in (
        ("fcdi", "σ_a (rad/s²)", sweeps.kinematic),
        ("fd", "σ_P (N m/√s)", sweeps.dynamic),
    ):
        columns = (
            "motion",
            unit,
            "RMS z",
            "RMS ż",
            "RMS τ_1 (N m)",
            "delay of ż (ms)",
            "median RMS τ_1 (N m)",
        )
        cells = [
            (
                motion,
                value,
                *(getattr(one, key).mean() for key in ("position", "velocity", "torque", "delay_ms")),
                float(np.median(one.torque)),
            )
            for motion, sweep in family.items()
            for value, one in zip(sweep.values, sweep.scores, strict=True)
        ]
        sheets.append(Sheet(f"sweep_{name}", f"Covariance sweep of {name.upper()}", columns, tuple(cells)))
    return Findings(rows, sheets, _claims(sweeps, best))


def _claims(sweeps: Sweeps, best: dict[str, float]) -> list[Claim]:
    kinematic, dynamic = (
        family["sin"].quantiles("torque", 0.5)[0] for family in (sweeps.kinematic, sweeps.dynamic)
    )
    rises = [float(curve[-1] / curve.min()) for curve in (kinematic, dynamic)]
    return [
        Claim(
            "Figure 3.12",
            "FCDI's torque error approaches an asymptote as σ_a grows.",
            f"U-shaped: least {kinematic.min():.1f} N m near σ_a = {sweeps.kinematic['sin'].best:.2g}, at the largest "
            f"σ_a {rises[0]:.1f} times that",
            judged(rises[0] < 1.1),
        ),
        Claim(
            "Figures 3.13, 3.14",
            "FD's torque error falls almost asymptotically with σ_P, far later than FCDI's with σ_a.",
            f"U-shaped: least {dynamic.min():.1f} N m, at the largest σ_P {rises[1]:.1f} times that",
            judged(rises[1] < 1.1),
        ),
        Claim(
            "3.3.4",
            "The best σ_P lies between 500 and 1000, and no value is best for all states.",
            f"for τ_1 {best['sin']:.0f} (sin) and {best['squat']:.0f} (squat); for ż of sin "
            f"{sweeps.dynamic['sin'].values[np.argmin(sweeps.dynamic['sin'].mean('velocity'))]:.0f}",
            judged(
                all(500.0 <= one <= 1000.0 for one in best.values()),
                any(500.0 <= v <= 1000.0 for v in best.values()),
            ),
        ),
        _best_against_best(sweeps),
    ]


def _best_against_best(sweeps: Sweeps) -> Claim:
    best = [
        sweep.scores[int(np.argmin(sweep.mean("torque")))]
        for sweep in (sweeps.dynamic["sin"], sweeps.kinematic["sin"])
    ]
    ratio = best[0].torque / best[1].torque
    won = 100.0 * float((ratio > 1.0).mean())
    return Claim(
        "Figure 3.18",
        "With exact masses FCDI estimates this torque better, though in general neither filter wins.",
        f"each at its best, FD's error is {ratio.mean():.2f} times FCDI's; FCDI is better in {won:.0f} % of seeds",
        judged(ratio.mean() > 1.0 and 20.0 < won < 95.0, ratio.mean() > 1.0),
    )


def sensor_findings(lab: Laboratory) -> Findings:
    """Sensors taken away or added one by one, and residual states from none to free ones."""
    sets = {"standard": STANDARD_SENSORS, "with τ_1": SENSORS}
    sets |= {f"without {name}": tuple(s for s in STANDARD_SENSORS if s != name) for name in STANDARD_SENSORS}
    sensors = {name: replace(FD, settings=replace(FD.settings, sensors=used)) for name, used in sets.items()}
    residuals = {
        "none" if value is None else f"{value:g}": replace(
            FD, settings=replace(FD.settings, residual_noise=value)
        )
        for value in RESIDUALS
    }
    groups = [[Pair(STUDY_RECIPE, one) for one in methods.values()] for methods in (sensors, residuals)]
    found = lab.measure_groups("Sensors and residual", groups, FEW_SEEDS)
    sheets = []
    for (name, title, first), methods, scores in zip(
        (
            ("sensors", "FD with sensors switched one by one (sin, medians)", "sensors"),
            ("residual", "FD with and without residual states (sin, medians)", "residual noise (N, N m /√s)"),
        ),
        (sensors, residuals),
        found,
        strict=True,
    ):
        cells = tuple((key, *_medians(one)) for key, one in zip(methods, scores, strict=True))
        sheets.append(Sheet(name, title, (first, "RMS z", "RMS ż", "RMS τ_1 (N m)"), cells))
    return Findings(sheets=sheets)


def _medians(one: Scores) -> tuple[float, float, float]:
    position, velocity, torque = (float(np.median(part)) for part in (one.position, one.velocity, one.torque))
    return position, velocity, torque
