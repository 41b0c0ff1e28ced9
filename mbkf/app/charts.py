"""Choices of the page's charts: convention, name of moments, colours of right and left."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from mbkf.trial.gait.convention import CLINICAL, INTERNAL, Convention, convention_of
from mbkf.viz.page import BLUE_RED


@dataclass(frozen=True)
class Charts:
    """The choices, by the names of :mod:`mbkf.trial.gait.convention` and :data:`mbkf.viz.page.COLOURS`."""

    convention: str = CLINICAL
    moments: str = INTERNAL
    colours: str = BLUE_RED

    def chosen(self, query: Mapping[str, str]) -> Charts:
        """These choices with those of a query."""
        names = ("convention", "moments", "colours")
        return Charts(*(query.get(name) or str(getattr(self, name)) for name in names))

    @property
    def read(self) -> Convention:
        """The convention.

        Raises:
            UnknownName: It does not exist.
        """
        return convention_of(self.convention, self.moments)
