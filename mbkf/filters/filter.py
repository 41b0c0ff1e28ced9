"""The filter: a plant predicts, blocks decide and speak, one update follows; no block is known here by name.

    x⁻ = f(x),  P⁻ = Φ P Φᵀ + Q                        plant
    Λ = Σ HᵀR⁻¹H,  λ = Σ HᵀR⁻¹y                         blocks, linearised at x⁻
    P⁺ = (P⁻⁻¹ + Λ)⁻¹,  x⁺ = x⁻ ⊕ P⁺ λ                  update, without inverting P⁻ (mbkf.numerics.information_update)

The kinematic, torque and dynamic filters are this class with another plant and other blocks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Generic, NamedTuple, Protocol, TypeVar

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.innovations import Innovations, InnovationSpreads
from mbkf.filters.once import Once
from mbkf.filters.readings import Readings, summed
from mbkf.kernel.covariance import correction, informed_with_rows
from mbkf.model.body import Body
from mbkf.numerics.kalman import correct
from mbkf.numerics.running_spread import RunningSpread
from mbkf.sensors.block import AnyBlock, Block, Frame, Notes, OperatingPoint, State
from mbkf.sensors.layout import Layout

Update = Callable[[Array, Array, Array], Array]
"""P⁺ (N, N) of a prior P⁻ (N, N), information Λ (n, n) on its first components and whitened rows (k, N)."""

StateT = TypeVar("StateT", bound=State)


class Plant(Protocol[StateT]):
    """How a state moves from one frame to the next.

    Attributes:
        model: The body that moves, to which blocks are bound.
        layout: Slices of its tangent state.
        dt_s: Time step.
    """

    model: Body
    layout: Layout
    dt_s: float

    def begin(self) -> Any:
        """Memory before the first frame."""

    def noise(self, memory: Any) -> Any:
        """Process noise of the next step, adapted to what the motion was like."""

    def predict(self, state: StateT, noise: Any) -> StateT:
        """The state one step later, P⁻ = Φ P Φᵀ + Q exactly symmetric, new and in Fortran order."""

    def transition(self, state: StateT) -> Array:
        """(N, N) Φ at a state."""

    def retract(self, state: StateT, step: Array, P: Array) -> StateT:
        """The state moved along its tangent space.

        Args:
            state: The state.
            step: (N,) tangent vector.
            P: (N, N) covariance of the moved state.
        """

    def difference(self, origin: StateT, state: StateT) -> Array:
        """(N,) tangent vector from one state's mean to another's."""

    def remember(self, posterior: StateT, notes: Notes, memory: Any) -> Any:
        """Memory for the next frame.

        Args:
            posterior: Corrected state.
            notes: What the blocks noted of the frame.
            memory: Of the frame before.
        """


class Memory(NamedTuple):
    """What a frame leaves for the next besides its estimate: memories of plant and blocks, and spreads of readings."""

    plant: Any
    blocks: Sequence[Any]
    spreads: RunningSpread


class Prior(NamedTuple, Generic[StateT]):
    """A predicted state with what blocks worked out at it, before the frame is there.

    Attributes:
        state: x⁻ and P⁻.
        noise: Process noise it was predicted with.
        points: The state as each block sees it.
    """

    state: StateT
    noise: Any
    points: Sequence[OperatingPoint[StateT, Any]]


class Decisions(NamedTuple):
    """What a frame's readings were taken to be; with it a smoother linearises the same readings elsewhere.

    Attributes:
        noise: Process noise of the step into the frame.
        blocks: Decision of each block.
        notes: What blocks shared.
    """

    noise: Any
    blocks: Sequence[Any]
    notes: Notes


class Step(NamedTuple, Generic[StateT]):
    """One step of a filter; what only the next step or a report needs is worked out when asked for.

    Attributes:
        state: Posterior.
        prior: Prediction it came from.
        decisions: What the frame's readings were taken to be.
        readings: They, linearised at the prior.
        recall: Makes the memory for the next step, once, when it is first asked for: after the answer.
        judge: Makes its innovations against what is expected of them, once, when they are first asked for.
    """

    state: StateT
    prior: Prior[StateT]
    decisions: Decisions
    readings: Readings
    recall: Callable[[], Memory]
    judge: Callable[[], Innovations]

    @property
    def memory(self) -> Memory:
        """For the next step."""
        return self.recall()

    @property
    def innovations(self) -> Innovations:
        """The frame's innovations against what one frame's are expected to be."""
        return self.judge()

    @property
    def tracked(self) -> bool:
        """Whether enough instruments read, and the prediction was not far from most markers."""
        return self.decisions.notes.observed and not self.decisions.notes.lost

    @property
    def lost(self) -> bool:
        """Whether most markers, and at least half of all, were seen far from where they were predicted."""
        notes = self.decisions.notes
        return notes.lost and 2 * int(np.count_nonzero(notes.seen)) >= len(notes.seen)

    @property
    def refused(self) -> BoolArray:
        """(M,) markers seen but outside their gate."""
        notes = self.decisions.notes
        return notes.seen & ~notes.trusted if notes.trusted is not notes.seen else np.zeros_like(notes.seen)

    @property
    def nis_readings(self) -> int:
        """Number of readings in :attr:`nis`."""
        return self.readings.instruments.readings + len(self.readings.counted[1])

    @property
    def nis(self) -> float:
        """Normalised innovation squared of instruments and laws in the filter's own P and R; priors are no readings."""
        (rows, values), known, P = self.readings.counted, self.readings.instruments, self.prior.state.P
        if not len(values):
            n = len(known.vector)
            return correct(P[:n, :n], known).nis
        after = correct(P, known)
        innovation = values - rows @ after.step
        S = rows @ after.covariance @ rows.T + np.eye(len(rows))
        return after.nis + float(innovation @ np.linalg.solve(S, innovation))


class Filter(Generic[StateT]):
    """Extended Kalman filter on a manifold.

    Attributes:
        plant: How the state moves.
        blocks: Instruments, laws and priors, in the order in which they decide.
        layout: Slices of the tangent state.
    """

    def __init__(
        self, plant: Plant[StateT], blocks: Sequence[AnyBlock], update: Update = informed_with_rows
    ) -> None:
        """Makes the filter.

        Args:
            plant: How the state moves.
            blocks: Instruments, laws and priors, in the order in which they decide.
            update: Arithmetic of the update; all give the same up to rounding, and differ in speed.
        """
        self.plant, self.blocks, self.layout, self.update = plant, tuple(blocks), plant.layout, update
        self._spreads = InnovationSpreads(self.blocks, plant.dt_s)
        for block in self.blocks:
            block.bind(self.layout, plant.model)
        # Blocks that have something of their own to do; at these sizes empty calls count.
        self._inflating = self._with_own("inflate")
        self._reviewing = self._with_own("review")
        self._remembering = self._with_own("remember")
        self._preparing = self._with_own("prepare")

    def _with_own(self, method: str) -> list[tuple[int, AnyBlock]]:
        """Numbers and blocks that override a method of :class:`mbkf.sensors.block.Block`."""
        own = getattr(Block, method)
        return [(k, one) for k, one in enumerate(self.blocks) if getattr(type(one), method) is not own]

    def begin(self) -> Memory:
        """Memory before the first frame."""
        return Memory(self.plant.begin(), [block.begin() for block in self.blocks], self._spreads.begin())

    def predict(self, state: StateT, memory: Memory) -> Prior[StateT]:
        """All that can be worked out before the frame is there."""
        noise = self.plant.noise(memory.plant)
        return self.prepared(self.plant.predict(state, noise), noise, memory)

    def prepared(self, state: StateT, noise: Any, memory: Memory) -> Prior[StateT]:
        """A state as a prior: what blocks work out at it without the frame.

        Args:
            state: The state; its covariance is changed in place by :meth:`correct`.
            noise: Process noise it was predicted with.
            memory: Of the frame before.
        """
        return Prior(state, noise, self._points(state, memory.blocks))

    def _points(self, state: StateT, memory: Sequence[Any] | None) -> list[OperatingPoint[StateT, Any]]:
        """The state as each block sees it; ``memory`` is None for a smoother."""
        points = [OperatingPoint(state, None)] * len(self.blocks)
        for k, block in self._preparing:
            points[k] = OperatingPoint(state, block.prepare(state, None if memory is None else memory[k]))
        return points

    def prepared_by(self, kind: type[AnyBlock], prior: Prior[StateT]) -> Any:
        """What the first block of a kind has worked out at a prior.

        Raises:
            LookupError: The filter has no such block.
        """
        for block, at in zip(self.blocks, prior.points, strict=True):
            if isinstance(block, kind):
                return at.prepared
        raise LookupError(f"the filter has no block {kind.__name__}")

    def step(
        self, state: StateT, memory: Memory, frame: Frame, prior: Prior[StateT] | None = None
    ) -> Step[StateT]:
        """Prediction and correction by one frame.

        Args:
            state: Posterior of the frame before.
            memory: Of the frame before.
            frame: The readings.
            prior: What :meth:`predict` made of state and memory; used up.
        """
        return self.correct(prior or self.predict(state, memory), memory, frame)

    def correct(self, prior: Prior[StateT], memory: Memory, frame: Frame) -> Step[StateT]:
        """Correction of a prior by one frame.

        Args:
            prior: The prediction; its covariance is changed in place.
            memory: Of the frame before.
            frame: The readings.
        """
        state, points, notes = prior.state, prior.points, Notes()
        chosen, said = [], []
        for block, at, kept in zip(self.blocks, points, memory.blocks, strict=True):
            chosen.append(block.decide(at, frame, kept, notes))
        self.inflate(state.P, chosen)
        for block, at, one in zip(self.blocks, points, chosen, strict=True):
            said.append(block.linearise(at, one))
        readings = summed(self.blocks, said, self.layout)
        posterior = self._updated(state, readings)
        again = [(k, block, block.review(posterior, chosen[k])) for k, block in self._reviewing]
        for k, block, one in again:
            if one is not None:
                chosen[k], said[k] = one, block.linearise(points[k], one)
        if any(one is not None for _, _, one in again):
            readings = summed(self.blocks, said, self.layout)
            posterior = self._updated(state, readings)

        read = Once(lambda: self._spreads.read(chosen, said))
        judge = Once(lambda: self._spreads.innovations(memory.spreads, read()))

        def remembered() -> Memory:
            kept = list(memory.blocks)
            for k, block in self._remembering:
                kept[k] = block.remember(posterior, points[k], chosen[k], kept[k])
            spreads = self._spreads.after(memory.spreads, read())
            return Memory(self.plant.remember(posterior, notes, memory.plant), kept, spreads)

        decisions = Decisions(prior.noise, chosen, notes)
        return Step(posterior, prior, decisions, readings, Once(remembered), judge)

    def inflate(self, P: Array, chosen: Sequence[Any]) -> None:
        """Adds to a predicted covariance, in place, the process noise that depends on the blocks' decisions."""
        for k, block in self._inflating:
            block.inflate(P, chosen[k])

    def linearise(self, state: StateT, decisions: Decisions) -> Readings:
        """A frame's readings, decided before, linearised at another state (for smoothing)."""
        asked = zip(self.blocks, self._points(state, None), decisions.blocks, strict=True)
        said = [block.linearise(at, one) for block, at, one in asked]
        return summed(self.blocks, said, self.layout)

    def _updated(self, prior: StateT, readings: Readings) -> StateT:
        P = self.update(prior.P, readings.matrix, readings.rows)
        step = correction(P, readings.vector, readings.rows, readings.values)
        if readings.added is not None:
            step += P @ readings.added
        return self.plant.retract(prior, step, P)
