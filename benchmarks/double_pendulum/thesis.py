"""What the thesis prints of its double pendulum: settings (Tables 3.1, A.1) and results (Tables A.2, A.3)."""

from __future__ import annotations

from dataclasses import dataclass

from benchmarks.double_pendulum.kinematic import KinematicMethod
from benchmarks.double_pendulum.motions import PendulumNoise
from benchmarks.double_pendulum.pendulum import PendulumShape
from benchmarks.double_pendulum.torque import PendulumSettings, TorqueMethod
from benchmarks.double_pendulum.trials import Recipe
from benchmarks.thesis_report.contents import Row, Sheet
from mbkf.filters.torque.plant import Scheme
from mbkf.filters.torque.settings import SCHEMES

STUDY = PendulumShape(mass_1_kg=50.0, mass_2_kg=25.0)
"""Table 3.1, the pendulum of all studies."""

ANNEX = PendulumShape(mass_1_kg=50.0, mass_2_kg=35.0)
"""Table A.1, the pendulum of Tables A.2 and A.3."""

STUDY_RECIPE = Recipe(shape=STUDY)
ANNEX_RECIPE = Recipe(shape=ANNEX, noise=PendulumNoise(force_n=0.05, moment_nm=0.005))
"""Departs from thesis Table A.1 in the markers' noise, that of Table 3.1: else the printed errors cannot be had."""

EFFORT_NOISE = 1000.0
"""σ_P of the dynamic filter unless a study sweeps it; the thesis leaves it open."""

KINEMATIC_ACCELERATION = 10.0
"""σ_a of FCDI likewise: near the least error of τ_1."""

SLUGGISH_ACCELERATION = 3.0
"""σ_a of FCDI where its delay is measured; the thesis leaves it open."""

FD = TorqueMethod(STUDY, PendulumSettings(SCHEMES["FD"], EFFORT_NOISE))
FDMC = TorqueMethod(STUDY, PendulumSettings(SCHEMES["FDMC"], EFFORT_NOISE))
FCDI = KinematicMethod(STUDY, KINEMATIC_ACCELERATION)

PROPAGATIONS = {"PE": "first", "SE": "second", "EX": "exponential"}
COVARIANCES = {"CT": "series", "VL": "van_loan"}
"""The thesis's names and ours."""


@dataclass(frozen=True)
class Printed:
    """A printed row: RMS of z, ż and F_e, and real time over computing time."""

    position: float
    velocity: float
    torque: float
    speed: float


TABLE_A2 = {
    "FE PE CT": Printed(0.0261, 0.1553, 19.4465, 47.7306),
    "FE PE VL": Printed(0.0261, 0.1627, 19.5753, 22.0392),
    "FE SE CT": Printed(0.0261, 0.1598, 19.5131, 46.2945),
    "FE SE VL": Printed(0.0261, 0.1651, 21.8711, 23.8323),
    "FE EX CT": Printed(0.0261, 0.1623, 19.3495, 35.9034),
    "FE EX VL": Printed(0.0261, 0.1664, 21.5921, 20.4209),
    "HE PE CT": Printed(0.0261, 0.1531, 17.7505, 45.9877),
    "HE PE VL": Printed(0.0261, 0.1551, 16.7944, 23.7618),
    "HE SE CT": Printed(0.0261, 0.1543, 16.2570, 44.6233),
    "HE SE VL": Printed(0.0261, 0.1552, 16.0403, 21.5970),
    "HE EX CT": Printed(0.0261, 0.1553, 16.0879, 34.2577),
    "HE EX VL": Printed(0.0261, 0.1559, 15.9672, 20.9438),
    "TF PE CT": Printed(0.0261, 0.1532, 17.7547, 34.0539),
    "TF PE VL": Printed(0.0261, 0.1552, 16.7579, 19.2930),
    "TF SE CT": Printed(0.0261, 0.1544, 16.2760, 34.1616),
    "TF SE VL": Printed(0.0261, 0.1553, 16.0654, 19.9932),
    "TF EX CT": Printed(0.0261, 0.1553, 16.0974, 27.8971),
    "TF EX VL": Printed(0.0261, 0.1560, 15.9900, 15.5171),
    "TN PE CT": Printed(0.0261, 0.1532, 17.7547, 23.4355),
    "TN PE VL": Printed(0.0261, 0.1552, 16.7579, 13.2081),
    "TN SE CT": Printed(0.0261, 0.1544, 16.2760, 22.5510),
    "TN SE VL": Printed(0.0261, 0.1553, 16.0654, 13.2316),
    "TN EX CT": Printed(0.0261, 0.1553, 16.0974, 14.4122),
    "TN EX VL": Printed(0.0261, 0.1560, 15.9900, 9.6676),
}
"""Errors of one realisation, by integrator, propagation and covariance."""

TABLE_A3 = {
    "complete": Printed(0.0261, 0.1598, 19.5131, 46.2945),
    "simplified": Printed(0.0261, 0.1684, 18.8361, 54.7290),
}
"""FE SE CT with either sensitivity matrix F."""


def annex_method(name: str, complete: bool = True, effort_noise: float = EFFORT_NOISE) -> TorqueMethod:
    """The dynamic filter of a row of Table A.2, such as "FE PE CT".

    Args:
        name: Name of the row.
        complete: Whether the complete transition matrix F is used instead of the simplified one.
        effort_noise: Process noise σ_P of the efforts.
    """
    integrator, propagation, covariance = name.split()
    scheme = Scheme(integrator, PROPAGATIONS[propagation], COVARIANCES[covariance], complete)
    return TorqueMethod(ANNEX, PendulumSettings(scheme, effort_noise, force_n=0.05, moment_nm=0.05))


def settings_sheet() -> Sheet:
    """The settings of all studies as a table, those the thesis leaves open included."""
    studies, annex = STUDY_RECIPE.noise, ANNEX_RECIPE.noise
    ours, printed = FD.settings, annex_method("TN EX VL").settings
    rows: tuple[Row, ...] = (
        ("masses of bars 1 and 2 (kg)", *(f"{one.mass_1_kg:g}, {one.mass_2_kg:g}" for one in (STUDY, ANNEX))),
        ("length of a bar (m)", *(f"{one.length_m:g}" for one in (STUDY, ANNEX))),
        ("camera noise (m)", *(f"{one.camera_m:g}" for one in (studies, annex))),
        ("skin artefact (m), low pass at 0.5 Hz", *(f"{one.artefact_m:g}" for one in (studies, annex))),
        ("noise of force sensors (N)", *(f"{one.force_n:g}" for one in (studies, annex))),
        ("noise of moment sensors (N m)", *(f"{one.moment_nm:g}" for one in (studies, annex))),
        ("filter: markers (m)", *(f"{one.marker_m:g}" for one in (ours, printed))),
        (
            "filter: forces (N), moments (N m)",
            *(f"{b.force_n:g}, {b.moment_nm:g}" for b in (ours, printed)),
        ),
        ("filter: plant σ_P (N/√s, N m/√s)", *(f"{one.effort_noise:g}" for one in (ours, printed))),
        ("filter: residual (N/√s, N m/√s)", *(f"{one.residual_noise:g}" for one in (ours, printed))),
    )
    note = (
        "100 Hz, 3 s, started at the truth. FD: trapezoidal rule by Newton, exponential, Van Loan; FDMC: forward "
        f"Euler, second order, series, simplified F; FCDI: σ_a = {KINEMATIC_ACCELERATION:g} where nothing else is said."
    )
    return Sheet(
        "settings", "Settings", ("", "studies (Table 3.1)", "Tables A.2, A.3 (Table A.1)"), rows, note
    )
