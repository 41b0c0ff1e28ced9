"""Settings of the torque-state filter: the thesis's own, and those that run.

Measured at 100 Hz on the motions of ``mbkf synth`` (seed 0, 3 mm skin, 0.5 mm cameras, started from the kinematic
filter and inverse dynamics) and on a real walk (Rajagopal 2016): RMS error of the joint torques in N m (of FCDI:
squat 7.7, walk 8.8, jump 8.5), and RMS change of the plate forces that the filter wants, in N.

| preset | squat | walk | jump | real walk |
|---|---|---|---|---|
| FD | 1.7, 0 N | 3.4, 0.1 N | 5.8, 0.1 N | 0.1 N |
| FDMC | 1.7, 0 N | 3.6, 0.1 N | 6.2, 0.1 N | 0.1 N |
| FD, literal | 5.8, 14 N | 15, 143 N | diverges at frame 181 | 112 N |
| FDMC, literal | 6.2, 14 N | diverges at frame 185 | diverges at frame 120 | 113 N |
| FD, literal, per frame | 1.9, 1 N | 7.6, 18 N | 8.8, 10 N | 11 N |
| FDMC, literal, per frame | 2.0, 1 N | 8.1, 18 N | 9.4, 10 N | 11 N |

Read as spectral densities, the covariances of Table 4.3 let a plate force change by 2 N in a frame where
walking changes it by 90 N: the filter lags, bends the motion, and loses it where it is quick. Ten sub-steps or a
wrench on the ankle change none of this. Read as what a frame adds they follow, if noisily. FD and FDMC therefore
depart from thesis Table 4.3. What these stable settings change, each of which helps: "inertial" force states (see
FORCE_STATES), which also leave the simplified F little to neglect; noise in which forces follow accelerations and
loads; a start that agrees with the plates; a residual that is pulled to zero instead of walking away.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from mbkf.errors import InvalidInput, UnknownName
from mbkf.filters.given_settings import with_given
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.torque.plant import Scheme
from mbkf.io.preset import read_preset, shipped_presets
from mbkf.model.human_dynamics import FORCE_STATES, WRENCH_FRAMES

MASS_OF_TABLE_KG = 100.0
"""Covariances of forces scale with the subject's mass over this (thesis eq. 4.18)."""

PLATES = ("sensors", "inputs")
"""Parts of force plates in the filter, see :mod:`mbkf.sensors.foot_plates` and :mod:`mbkf.sensors.given_plates`."""

SENSED = {"only_with": ("plates", "sensors")}
"""Of a setting that matters where wrenches are states."""

NOISES = ("consistent", "independent")
"""Process noise of the forces, see :mod:`mbkf.filters.torque.noise`."""


@dataclass(frozen=True)
class TorqueSettings:
    """Noise and structure of the torque-state filter.

    Forces and moments are for a subject of 100 kg and scale with the subject's mass (thesis eq. 4.18).

    Attributes:
        scheme: Integrator, propagation and covariance.
        tracking: Gate, weak pulls and scale of the marker noise, as in the kinematic filter.
        force_state: "inertial" or "torque", see :data:`mbkf.model.human_dynamics.FORCE_STATES`.
        plates: "sensors": wrenches of the feet are states that plates read; "inputs": the plates' wrenches are known
            and enter the equations of motion, without noise, and the wrenches leave the state (thesis 3.2.3).
        wrench_frame: "ankle", "foot" or "thesis", see :data:`mbkf.model.human_dynamics.WRENCH_FRAMES`.
        noise: "consistent": accelerations and foot loads change freely, and forces with them;
            "independent": every force by itself (thesis 3.2.3).
        jerk_scale: Noise of accelerations per √s as a multiple of the body's table of accelerations; "consistent".
        toe_acceleration: Acceleration noise of the toes, rad/s²; None for the body's table.
        load_force_n, load_moment_nm: Noise of the foot wrenches, N/√s and N m/√s.
        load_vertical_force_n: That of vertical forces; None: as of horizontal ones, ``load_force_n``.
        plate_force_n, plate_moment_nm: Standard deviation of a plate's reading, moments about the ankle.
        plate_vertical_force_n: That of vertical forces; None: as of horizontal ones, ``plate_force_n``.
        unloaded_force_n, unloaded_moment_nm: The same for a foot that certainly carries nothing.
        residual_force_n, residual_moment_nm: Residual noise σᴿ, N/√s and N m/√s; with ``force_state`` "torque".
        residual_vertical_force_n: That of the vertical force; None: as of horizontal ones, ``residual_force_n``.
        residual_spread_force_n, residual_spread_moment_nm: Spread of the residual about 0, per frame; infinite
            where it is a random walk alone.
        upper_torque_nm, lower_torque_nm: Torque noise of upper and lower body, N m/√s; "independent" only.
        per_frame: Whether "independent" noise is what a frame adds (N, N m) rather than a density.
    """

    scheme: Scheme = field(default_factory=Scheme)
    tracking: KinematicSettings = field(default_factory=KinematicSettings)
    force_state: str = field(default="inertial", metadata={"words": FORCE_STATES})
    plates: str = field(default="sensors", metadata={"words": PLATES})
    wrench_frame: str = field(default="ankle", metadata={"words": WRENCH_FRAMES, **SENSED})
    noise: str = field(default="consistent", metadata={"words": NOISES})
    jerk_scale: float = field(default=3.0, metadata={"only_with": ("noise", "consistent")})
    toe_acceleration: float | None = field(default=None, metadata={"absent": "table"})
    load_force_n: float = field(default=1000.0, metadata=SENSED)
    load_vertical_force_n: float | None = field(default=None, metadata={"absent": "same", **SENSED})
    load_moment_nm: float = field(default=100.0, metadata=SENSED)
    plate_force_n: float = field(default=5.0, metadata=SENSED)
    plate_vertical_force_n: float | None = field(default=None, metadata={"absent": "same", **SENSED})
    plate_moment_nm: float = field(default=2.0, metadata=SENSED)
    unloaded_force_n: float = field(default=0.1, metadata=SENSED)
    unloaded_moment_nm: float = field(default=0.02, metadata=SENSED)
    residual_force_n: float = field(default=10.0, metadata={"zero": True})
    residual_vertical_force_n: float | None = field(default=None, metadata={"absent": "same", "zero": True})
    residual_moment_nm: float = field(default=5.0, metadata={"zero": True})
    residual_spread_force_n: float = field(default=10.0, metadata={"infinite": True})
    residual_spread_moment_nm: float = field(default=5.0, metadata={"infinite": True})
    upper_torque_nm: float = field(default=5.0, metadata={"only_with": ("noise", "independent")})
    lower_torque_nm: float = field(default=20.0, metadata={"only_with": ("noise", "independent")})
    per_frame: bool = False

    def __post_init__(self) -> None:
        """Refuses settings that contradict each other.

        Raises:
            InvalidInput: They do.
        """
        if self.per_frame and self.noise != "independent":
            raise InvalidInput(
                f'per_frame reads the standard deviations of "independent" noise as those of a frame, and noise is '
                f'"{self.noise}"; give noise = "independent", or per_frame = false'
            )
        spread = (self.residual_spread_force_n, self.residual_spread_moment_nm)
        if self.force_state == "inertial" and not all(map(math.isfinite, spread)):
            raise InvalidInput(
                'force_state "inertial" needs a finite residual_spread_force_n and residual_spread_moment_nm, '
                "which alone tie the plates to the motion; "
                'give finite ones, or force_state = "torque"'
            )


SCHEMES = {
    "FD": Scheme("TN", "exponential", "van_loan"),
    "FDMC": Scheme("FE", "second", "series", complete=False),
}
"""The thesis's two filters: the exact one and the one light enough for real time.

FDMC departs from thesis eq. 3.51, which the thesis cites for its propagation of second order: that is thesis eq. 3.52.
"""


def preset(name: str, *, literal: bool = False) -> TorqueSettings:
    """Settings of the thesis's FD or FDMC, from the preset files that come with mbkf.

    Args:
        name: "FD" or "FDMC".
        literal: Whether state and noise are the thesis's, too (3.2.3, 4.1.4.1, Table 4.3).

    Raises:
        UnknownName: The preset does not exist.
    """
    if name not in SCHEMES:
        raise UnknownName("torque filter", name, SCHEMES)
    file = shipped_presets()[f"{name}-literal" if literal else name]
    return with_given(TorqueSettings(), read_preset(file).values, str(file))
