"""Settings of a reconstruction: filter, later frames, omissions, axes of angles."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field

import numpy as np

from mbkf.errors import InvalidInput
from mbkf.filters.dynamic.settings import DynamicSettings
from mbkf.filters.fixed_lag import SmoothingSettings
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.settings import flat
from mbkf.filters.spread import ASKED
from mbkf.filters.torque.settings import TorqueSettings
from mbkf.io.preset import Value
from mbkf.io.results import LAG_KEY
from mbkf.kernel.loading import kernel_name
from mbkf.trial.emg.settings import EmgSettings


@dataclass(frozen=True)
class Hidden:
    """Markers to take away between two times, s, to see the effect of occlusion."""

    names: tuple[str, ...]
    from_s: float
    to_s: float


@dataclass(frozen=True)
class ReconstructSettings:
    """Settings of a reconstruction.

    Attributes:
        filter: Which filter; "kinematic" is the marker filter followed by inverse dynamics, "torque" the thesis's
            dynamic filter, "dynamic" ours.
        smooth: All later frames correct earlier ones; None: yes, unless a lag is set. False is the causal answer,
            which a live run gives.
        smoothing: How far they do.
        lag_s: Instead of smoothing, the fixed lag: time that a frame waits for readings that correct it; 0: no lag.
        kinematic, dynamic, torque: Settings of each filter.
        correct_markers: Whether marker positions are corrected on the trial first (thesis 4.1.1).
        hide: Markers to hide.
        without_plates: Names of plates to withhold.
        pelvis: The frame of the pelvis's angles: "progression", or "lab" for the laboratory's axes.
        angles: The axes that angles are read in: "model" for the body's own, "isb" for the ISB's, "pig" for
            Plug-in Gait's.
        angles_zero: Zero of angles: "axes" where a joint's axes coincide, "static" for the posture of the static trial.
        convention: The convention of curves in reports and tables of the result: "clinical", "isb" or "model"
            (:mod:`mbkf.trial.gait.convention`). The result itself is the same in each.
        keep_covariance: Whether full covariances are kept in memory.
        other_contacts: Whether parts besides the feet may bear load: a seat, a knee or a hand on the floor, a load in
            the hands. Only the dynamic filter knows of them.
        checks: Whether mass, plates, clocks and markers are checked against each other (:mod:`mbkf.trial.checks`).
        spreads: Standard deviations given besides those of configuration, velocity and wrenches: "torques" and
            "angles". Frames with an estimated load do not count as valid without those of the torques.
        emg: Filters of the electromyograms.
        preset: Name of the preset, or of its file, of the filter's settings; empty without one. For the record.
        given: Single settings of the filter that a command gave besides, by name. For the record.
    """

    filter: str = "dynamic"
    smooth: bool | None = None
    smoothing: SmoothingSettings = field(default_factory=SmoothingSettings)
    lag_s: float = 0.0
    kinematic: KinematicSettings = field(default_factory=KinematicSettings)
    dynamic: DynamicSettings = field(default_factory=DynamicSettings)
    torque: TorqueSettings = field(default_factory=TorqueSettings)
    correct_markers: bool = True
    hide: tuple[Hidden, ...] = ()
    without_plates: tuple[str, ...] = ()
    pelvis: str = "progression"
    angles: str = "model"
    angles_zero: str = "axes"
    convention: str = "model"
    keep_covariance: bool = False
    other_contacts: bool = True
    checks: bool = True
    spreads: tuple[str, ...] = ASKED
    emg: EmgSettings = field(default_factory=EmgSettings)
    preset: str = ""
    given: tuple[tuple[str, Value], ...] = ()

    def __post_init__(self) -> None:
        """Refuses a negative or infinite lag, a lag beside smoothing, and unknown standard deviations.

        Raises:
            InvalidInput: It is so.
        """
        if not 0.0 <= self.lag_s < np.inf:
            raise InvalidInput(f"a lag of {self.lag_s:g} s is not possible: give a positive time")
        if not set(self.spreads) <= set(ASKED):
            raise InvalidInput(
                f"standard deviations of {', '.join(self.spreads)} are not known; choose among {', '.join(ASKED)}"
            )
        if self.smooth and self.lag_s > 0.0:
            raise InvalidInput(
                "smoothing uses all later frames, so a lag is not possible beside it; choose one"
            )

    @property
    def smooths(self) -> bool:
        """True where all later frames are used."""
        return self.lag_s == 0.0 if self.smooth is None else self.smooth


def recorded(settings: ReconstructSettings) -> dict[str, object]:
    """The settings as files hold them: the dynamic filter's by their leaves' names, the lag in ms, the kernel."""
    found: dict[str, object] = {
        **asdict(settings),
        "dynamic": flat(settings.dynamic),
        "given": dict(settings.given),
    }
    del found["lag_s"]
    lag_ms = round(1e3 * settings.lag_s, 6)
    return {**found, "smooth": settings.smooths, LAG_KEY: lag_ms, "kernel": kernel_name()}
