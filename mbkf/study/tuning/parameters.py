"""Tunable settings of each filter: groups of settings that are scaled by one factor."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from mbkf.errors import InvalidInput, UnknownName


@dataclass(frozen=True)
class TuningParameter:
    """Settings of a filter that are scaled together.

    Attributes:
        fields: The settings.
        lowest, highest: Range of the factor on their defaults.
        default: Whether it is tuned unless others are named.
        about: Its meaning.
    """

    fields: tuple[str, ...]
    lowest: float
    highest: float
    default: bool
    about: str


PARAMETERS: Mapping[str, Mapping[str, TuningParameter]] = {
    "dynamic": {
        "motion": TuningParameter(("acceleration_scale",), 0.1, 10.0, True, "how much the body accelerates"),
        "loads": TuningParameter(
            ("wrench_force", "wrench_moment"), 0.02, 20.0, True, "how fast foot loads change"
        ),
        "plates": TuningParameter(
            ("plate_force_n", "plate_moment_nm"), 0.1, 10.0, True, "noise of the plates"
        ),
        "law": TuningParameter(
            ("residual_force_n", "residual_moment_nm"), 0.1, 10.0, False, "how exactly Newton's law holds"
        ),
        "share": TuningParameter(("innovation_share",), 0.2, 10.0, False, "innovations over markers' noise"),
        "markers": TuningParameter(("marker_noise_scale",), 0.2, 5.0, False, "noise of the markers"),
    },
    "kinematic": {
        "motion": TuningParameter(("acceleration_scale",), 0.05, 20.0, True, "how much the body accelerates"),
        "markers": TuningParameter(("marker_noise_scale",), 0.1, 5.0, True, "noise of the markers"),
    },
}
"""Tunable settings, by filter and name."""


def parameter_names(filter_name: str, wanted: tuple[str, ...] | None) -> tuple[str, ...]:
    """Names of the parameters to tune, each once.

    Args:
        filter_name: "dynamic" or "kinematic".
        wanted: Names of :data:`PARAMETERS`; None: the default ones.

    Raises:
        UnknownName: The filter or a parameter does not exist.
        InvalidInput: No parameter is named.
    """
    if filter_name not in PARAMETERS:
        raise UnknownName("filter to tune", filter_name, PARAMETERS)
    known = PARAMETERS[filter_name]
    if wanted is None:
        return tuple(name for name, one in known.items() if one.default)
    for name in wanted:
        if name not in known:
            raise UnknownName("parameter", name, known, "--parameters")
    if not wanted:
        raise InvalidInput("--parameters: name at least one of " + ", ".join(known))
    return tuple(dict.fromkeys(wanted))
