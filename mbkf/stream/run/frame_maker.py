"""From a row of the log to a listener's frame: torques, wrenches and markers of the estimated body."""

from __future__ import annotations

from collections import deque

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.filters.inverse_dynamics import support_torques
from mbkf.filters.record import UNASKED
from mbkf.io.contacts import foot_sources
from mbkf.io.estimates import Estimates
from mbkf.io.quantities import quantities
from mbkf.io.results import PLOTTED
from mbkf.model.newton_euler import NewtonEuler
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.contact.records import KeptContact
from mbkf.stream.receiving.alignment import ReadyFrame
from mbkf.stream.results.frame import LiveFrame
from mbkf.stream.results.judgement import Judgement
from mbkf.trial.live.filter import LiveInputs
from mbkf.trial.loads.running import RunningLoad

UNEXPLAINED = "unexplained_force_n"
"""Name of the judged force among the curves of a frame."""

_PLOTTED = {name: one.key for name, one in PLOTTED.items() if name in quantities(Estimates)}

RATE_OVER_S = 1.0
"""The rate is counted over this time."""


class FrameMaker:
    """Makes :class:`LiveFrame` records."""

    def __init__(self, live: LiveInputs, rate_hz: float) -> None:
        """Args: the filter's inputs, and the stream's rate."""
        inputs = live.inputs
        self._sensor, self._rate_hz = inputs.sensor, rate_hz
        self._balance = NewtonEuler(inputs.sensor.model)
        self._feet = ContactDetector(inputs.sensor.model, inputs.plates, inputs.dt_s)
        self._memory: KeptContact = self._feet.begin()
        self._arrivals: deque[float] = deque()
        self._first: int | None = None

    def arrived(self, arrival_s: float) -> None:
        """A frame came, for the rate."""
        self._arrivals.append(arrival_s)
        while arrival_s - self._arrivals[0] > RATE_OVER_S:
            self._arrivals.popleft()

    def frame(
        self,
        ready: ReadyFrame,
        row: NDArray,
        latency_s: float,
        lost: int,
        load: RunningLoad | None = None,
        valid: bool = False,
        judgement: Judgement | None = None,
    ) -> LiveFrame:
        """A listener's frame.

        Args:
            ready: Its readings.
            row: (1,) the log's row of it.
            latency_s: From arrival to result.
            lost: Frames lost so far.
            load: Judgement of the force that no contact explains; None where there is none.
            valid: Its loads may be used.
            judgement: The judgement of the run so far.
        """
        if self._first is None:
            self._first = ready.number
        found = row[0]
        q, v, a = found["q"], found["v"], found["a"]
        torques, predicted = np.full(len(v), np.nan), np.full((len(found["measured_m"]), 3), np.nan)
        wrench, wrench_sd = found["wrench"], found["wrench_sd"]
        if found["known"]:
            if np.isnan(wrench).any():
                wrench = self._measured(q, v, a, ready.plates)
            torques = self._balance.tau(q, v, a, wrench.ravel())
            if np.nan_to_num(found["support"]).any():
                torques = torques - support_torques(self._sensor.model, q, found["support"])
            predicted = self._sensor.positions(q)
        contact = None if found["footing"][0] == UNASKED else found["footing"][None]
        return LiveFrame(
            number=ready.number - self._first,
            time_s=(ready.number - self._first) / self._rate_hz,
            q=q,
            v=v,
            torques=torques,
            torques_sd=found["torque_sd"],
            wrench=wrench,
            wrench_sd=wrench_sd,
            plates=ready.plates,
            measured_m=found["measured_m"],
            predicted_m=predicted,
            unlabelled_m=ready.unlabelled_m,
            angle_sd=found["angle_sd"],
            angle_offset=found["angle_offset"],
            torques_offset=found["torque_offset"],
            wrench_offset=found["wrench_offset"],
            latency_s=latency_s,
            lost=lost,
            rate_hz=self._rate(),
            tracked=bool(found["tracked"]),
            started=bool(found["started"]),
            foot_source=foot_sources(contact, wrench[None])[0],
            support=found["support"],
            support_sd=found["support_sd"],
            unexplained=load is not None and load.acts,
            valid=valid,
            judgement=judgement,
            plotted={name: np.asarray(found[key]) for name, key in _PLOTTED.items()}
            | ({} if load is None else {UNEXPLAINED: load.force_n}),
        )

    def _rate(self) -> float:
        if len(self._arrivals) < 2:
            return 0.0
        passed = self._arrivals[-1] - self._arrivals[0]
        return (len(self._arrivals) - 1) / passed if passed > 0.0 else 0.0

    def _measured(self, q: Array, v: Array, a: Array, plates: Array) -> Array:
        """(2, 6) measured wrench per foot, for a filter that estimates none."""
        load = self._feet.decide(self._memory, q, v, a, plates)
        self._memory = load.memory
        return load.wrench
