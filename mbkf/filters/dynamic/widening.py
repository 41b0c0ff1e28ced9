"""An estimate of the dynamic filter with room for more states, so that a contact can open while a motion goes on.

    x = (x_narrow, x_new),   P = [[P_narrow, 0], [0, diag(σ_new²)]]

The common states keep mean and covariance; new ones have mean and spread with which their block begins. Blocks of both
filters keep their memories.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mbkf.filters.dynamic.filter import DynamicFilter
from mbkf.filters.dynamic.plant import DynamicState
from mbkf.filters.dynamic.report import DynamicReport
from mbkf.filters.estimate import Posterior, Record
from mbkf.filters.filter import Memory
from mbkf.model.layout import Layout


def common_states(narrow: Layout, wide: Layout) -> NDArray[np.intp]:
    """(n,) places of a layout's states in one that has more.

    Args:
        narrow: The layout.
        wide: One with all of its parts.

    Raises:
        UnknownName: It lacks one of them.
    """
    places = [np.arange(wide[name].start, wide[name].stop) for name in narrow.slices]
    return np.concatenate(places)


def widened_state(state: DynamicState, narrow: Layout, wide: Layout) -> DynamicState:
    """A state with room for the states of a wider layout.

    Args:
        state: Mean and covariance.
        narrow: Its layout.
        wide: The layout with more states that blocks add.
    """
    common = common_states(narrow, wide)
    start, start_sd = wide.start()
    P = np.zeros((wide.size, wide.size), order="F")
    P[wide.extra, wide.extra] = np.diag(start_sd**2)
    P[np.ix_(common, common)] = state.P
    extra = start.copy()
    extra[common[narrow.extra] - wide.extra.start] = state.extra
    return replace(state, P=P, extra=extra)


def widened(estimate: Posterior, narrow: DynamicFilter, wide: DynamicFilter) -> Posterior:
    """An estimate from which a filter with more blocks goes on.

    Args:
        estimate: The estimate.
        narrow: The filter that made it.
        wide: One with blocks of the same kinds in the same order, and others among them.
    """
    memory: Memory = estimate.record.memory
    kept = dict(zip(map(type, narrow.blocks), memory.blocks, strict=True))
    blocks = [kept[type(block)] if type(block) in kept else block.begin() for block in wide.blocks]
    state = widened_state(estimate.record.state, narrow.layout, wide.layout)
    record = Record(state, None, memory._replace(blocks=blocks), estimate.record.detail)
    return estimate._replace(record=record)


class WiderFilter:
    """A filter with more states (:class:`mbkf.filters.tracking_filter.Widening`), made when it is first needed."""

    def __init__(self, narrow: DynamicFilter, make: Callable[[], DynamicReport]) -> None:
        """Args: the filter whose estimates are widened, and the function that makes the wider one's report."""
        self._narrow, self._make = narrow, make

    @cached_property
    def report(self) -> DynamicReport:
        """Reads the wide filter's states."""
        return self._make()

    def widened(self, estimate: Posterior) -> Posterior:
        """An estimate of the narrow filter, from which the wide one goes on."""
        return widened(estimate, self._narrow, self.report.kalman)
