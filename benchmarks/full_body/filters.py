"""The filters that the full-body studies compare, by the names and colours that they have on the page.

FCDI is the kinematic filter with inverse dynamics behind it. FDMC runs in three forms: as the thesis prints it, with
the covariances of its Table 4.3 read as densities (thesis eq. 2.47); the same with them read as what one frame adds;
and with the noise and force states of mbkf, which keep it stable. Every filter keeps its settings for all persons and
movements.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from benchmarks.dynamic.methods import Method
from benchmarks.thesis_report.figures import BLUE, GREEN, GREY, ORANGE
from mbkf.filters.torque.settings import TorqueSettings, preset

FCDI, FDMC_PRINTED, FDMC_PER_FRAME, FDMC, DYNAMIC = (
    "FCDI",
    "FDMC as printed",
    "FDMC per frame",
    "FDMC ours",
    "dynamic",
)
PER_FRAME = "#8e5ea2"
COLOURS = {FCDI: BLUE, FDMC_PRINTED: GREY, FDMC_PER_FRAME: PER_FRAME, FDMC: GREEN, DYNAMIC: ORANGE}


def _torque(settings: TorqueSettings) -> Method:
    return Method("torque", extra={"torque": settings})


CAUSAL: Mapping[str, Method] = {
    FCDI: Method("kinematic"),
    FDMC_PRINTED: _torque(preset("FDMC", literal=True)),
    FDMC_PER_FRAME: _torque(replace(preset("FDMC", literal=True), per_frame=True)),
    FDMC: _torque(preset("FDMC")),
    DYNAMIC: Method("dynamic"),
}
"""Every filter, frame by frame."""

SMOOTHED: Mapping[str, Method] = {
    f"{name}, smoothed": replace(CAUSAL[name], smooth=True) for name in (FCDI, FDMC, DYNAMIC)
}
"""Those that run stably, with later frames correcting earlier ones."""
