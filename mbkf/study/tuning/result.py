"""The result of tuning: factors, settings, likelihoods before and after, and the preset made of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from mbkf.io.preset import Preset, Value
from mbkf.version import __version__

FLAT_NATS = 2.0
"""A parameter is not determined if a factor of ``FLAT_FACTOR`` either way costs less than this."""

FLAT_FACTOR = 1.5


@dataclass(frozen=True)
class TunedParameter:
    """Result for one parameter.

    Attributes:
        name: Name of :data:`mbkf.study.tuning.parameters.PARAMETERS`.
        factor: Factor found on the defaults.
        cost_nats: Loss of log-likelihood when the factor is changed by ``FLAT_FACTOR`` either way, the smaller one.
        at_bound: Whether the factor ended at a bound of its range.
    """

    name: str
    factor: float
    cost_nats: float
    at_bound: bool

    @property
    def determined(self) -> bool:
        """True where the trials determine the parameter: its likelihood has a clear maximum."""
        return self.cost_nats >= FLAT_NATS


@dataclass(frozen=True)
class Tuned:
    """Result of tuning.

    Attributes:
        filter: Which filter.
        parameters: Result for each parameter.
        values: Settings found; those of parameters that are not determined are the defaults.
        defaults: The same settings before.
        likelihood: Nats per reading: "tuned_before", "tuned_after", "held_out_before", "held_out_after".
        tuned_on, held_out: Names of the trials.
        calls: Runs over the trials.
        settled: Whether the search converged.
        seconds: Time it took.
        start: Other settings with which the search began and which are not the filter's defaults.
    """

    filter: str
    parameters: tuple[TunedParameter, ...]
    values: Mapping[str, float]
    defaults: Mapping[str, float]
    likelihood: Mapping[str, float]
    tuned_on: tuple[str, ...]
    held_out: tuple[str, ...]
    calls: int
    settled: bool
    seconds: float
    start: Mapping[str, Value] = field(default_factory=dict)

    @property
    def better(self) -> bool:
        """True where the held-out readings are more probable than with the defaults."""
        return self.likelihood["held_out_after"] > self.likelihood["held_out_before"]

    @property
    def warnings(self) -> tuple[str, ...]:
        """Remarks for the user."""
        remarks = []
        if not self.better:
            remarks.append(
                "held-out readings are not more probable with the settings found; the preset keeps the defaults"
            )
        for one in self.parameters:
            if not one.determined:
                remarks.append(f"'{one.name}' is not determined by these trials and keeps its default")
            elif one.at_bound:
                remarks.append(f"'{one.name}' ended at the bound of its range")
        if not self.settled:
            remarks.append("the search used up its runs before it settled; give it more with --runs")
        return tuple(remarks)

    def preset(self, name: str) -> Preset:
        """The preset to save: the settings found, or the defaults where those were not better on held-out readings."""
        return Preset(
            name,
            self.filter,
            {**self.start, **(self.values if self.better else self.defaults)},
            __version__,
            "; ".join(self.warnings),
            self.tuned_on,
            self.held_out,
            {} if self.better else self.values,
            self.likelihood,
        )
