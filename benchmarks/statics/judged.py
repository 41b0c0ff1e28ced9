"""A static trial as it is and with each exchange of names: what scaling does about it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from benchmarks.statics.captures import Static, with_order
from benchmarks.statics.crossings import crossings
from mbkf.errors import MbkfError
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.model.protocol import Protocol
from mbkf.numerics.threads import single_threaded
from mbkf.scaling.frames import choose_frames
from mbkf.scaling.standing_names import likeliest_names
from mbkf.trial.preparation.static_names import static_put_right

Outcome = Literal["kept", "mended", "renamed otherwise", "refused"]


@dataclass(frozen=True)
class Judged:
    """A static trial and the outcome.

    Attributes:
        label: The capture and the exchange.
        clean: True where no names are exchanged.
        outcome: Names kept, right again, changed but not right, or the trial refused.
        misfit: E per marker that is left; NaN where it is refused.
    """

    label: str
    clean: bool
    outcome: Outcome
    misfit: float


def judged(static: Static) -> list[Judged]:
    """The static trial as it is, and with each exchange.

    Args:
        static: The static trial.
    """
    with single_threaded():
        markers, protocol = static.load()
        worn = choose_frames([markers], protocol, 1).markers
        own = {marker.name: name for name, marker in protocol.match(markers.names).items()}
        columns = [markers.names.index(own[marker.name]) for marker in worn]
        found = [_judged(static.name, markers, markers, protocol)]
        for name, order in crossings(protocol, worn, seed=sum(map(ord, static.name))).items():
            spoilt = with_order(markers, columns, order)
            found.append(_judged(f"{static.name}: {name}", spoilt, markers, protocol))
    return found


def _judged(label: str, spoilt: MarkerTrajectories, right: MarkerTrajectories, protocol: Protocol) -> Judged:
    try:
        put_right, pairs = static_put_right(Capture(label, spoilt), protocol)
    except MbkfError:
        return Judged(label, spoilt is right, "refused", float("nan"))
    misfit = likeliest_names(put_right.markers, protocol).misfit
    outcome: Outcome = "renamed otherwise" if pairs else "kept"
    if pairs and np.array_equal(put_right.markers.positions_m, right.positions_m, equal_nan=True):
        outcome = "mended"
    return Judged(label, spoilt is right, outcome, misfit)
