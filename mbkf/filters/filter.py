"""The filter: a plant predicts, blocks decide and speak, one update follows; no block is known here by name.

    x⁻ = f(x),  P⁻ = Φ P Φᵀ + Q                        plant (mbkf.filters.plant)
    Λ = Σ HᵀR⁻¹H,  λ = Σ HᵀR⁻¹y                         blocks, linearised at x⁻ (mbkf.sensors.block)
    P⁺ = (P⁻⁻¹ + Λ)⁻¹,  x⁺ = x⁻ ⊕ P⁺ λ                  update, without inverting P⁻ (mbkf.numerics.information_update)

The kinematic, torque and dynamic filters are this class with another plant and other blocks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Generic, NamedTuple

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.cached import Cached
from mbkf.filters.innovations import Innovations, InnovationSpreads
from mbkf.filters.plant import PlantOf, StateT
from mbkf.filters.readings import Readings, summed
from mbkf.kernel.covariance import correction, informed_with_rows
from mbkf.numerics.running_spread import RunningSpread
from mbkf.sensors.block import AnyBlock, Block, Frame, Notes, OperatingPoint, Statement

Update = Callable[[Array, Array, Array], Array]
"""P⁺ (N, N) of a prior P⁻ (N, N), information Λ (n, n) on its first components and whitened rows (k, N)."""


class Memory(NamedTuple):
    """Carried to the next frame besides the estimate: memories of plant and blocks, and spreads of readings."""

    plant: Any
    blocks: Sequence[Any]
    spreads: RunningSpread


class Prior(NamedTuple, Generic[StateT]):
    """A predicted state with the work of the blocks that needs no frame.

    Attributes:
        state: x⁻ and P⁻.
        noise: Process noise it was predicted with.
        points: The state as each block sees it.
    """

    state: StateT
    noise: Any
    points: Sequence[OperatingPoint[StateT, Any]]


class Decisions(NamedTuple):
    """Decisions on a frame's readings; with them a smoother linearises the same readings elsewhere.

    Attributes:
        noise: Process noise of the step into the frame.
        blocks: Decision of each block.
        notes: Notes that the blocks shared.
    """

    noise: Any
    blocks: Sequence[Any]
    notes: Notes


class Step(NamedTuple, Generic[StateT]):
    """One step of a filter.

    Attributes:
        state: Posterior.
        prior: Prediction it came from.
        decisions: Decisions on the frame's readings.
        readings: The readings, linearised at the prior.
        cached_memory: Memory for the next step, computed when first asked for: after the answer.
        cached_innovations: Innovations against their expected spread, likewise.
    """

    state: StateT
    prior: Prior[StateT]
    decisions: Decisions
    readings: Readings
    cached_memory: Cached[Memory]
    cached_innovations: Cached[Innovations]

    @property
    def memory(self) -> Memory:
        """Memory for the next step."""
        return self.cached_memory()

    @property
    def innovations(self) -> Innovations:
        """The frame's innovations against their expected spread."""
        return self.cached_innovations()

    @property
    def tracked(self) -> bool:
        """True where enough instruments read, and the prediction was not far from most markers."""
        return self.decisions.notes.observed and not self.decisions.notes.lost

    @property
    def lost(self) -> bool:
        """True where most markers, and at least half of all, were seen far from their prediction."""
        notes = self.decisions.notes
        return notes.lost and 2 * int(np.count_nonzero(notes.seen)) >= len(notes.seen)

    @property
    def refused(self) -> BoolArray:
        """(M,) markers seen but outside their gate."""
        notes = self.decisions.notes
        if notes.trusted is notes.seen:
            return np.zeros(len(notes.seen), dtype=bool)
        return notes.seen & ~notes.trusted


class Filter(Generic[StateT]):
    """Extended Kalman filter on a manifold.

    Attributes:
        plant: Motion of the state.
        blocks: Instruments, laws and priors, in the order in which they decide.
        layout: Slices of the tangent state.
        follows_spreads: False where innovations are not asked for; their running spreads then stay the expected ones.
    """

    def __init__(
        self, plant: PlantOf[StateT], blocks: Sequence[AnyBlock], update: Update = informed_with_rows
    ) -> None:
        """Makes the filter.

        Args:
            plant: Motion of the state.
            blocks: Instruments, laws and priors, in the order in which they decide.
            update: Arithmetic of the update; all give the same up to rounding, and differ in speed.
        """
        self.plant, self.blocks, self.layout, self.update = plant, tuple(blocks), plant.layout, update
        self._spreads, self.follows_spreads = InnovationSpreads(self.blocks, plant.dt_s), True
        for block in self.blocks:
            block.bind(self.layout, plant.model)
        # Blocks that override a method; at these sizes empty calls count.
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
        """The prior of the next frame, with all work that needs no frame."""
        noise = self.plant.noise(memory.plant)
        return self.prepared(self.plant.predict(state, noise), noise, memory)

    def prepared(self, state: StateT, noise: object, memory: Memory) -> Prior[StateT]:
        """A state as a prior.

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

    def prepared_by(self, kind: type[AnyBlock], prior: Prior[StateT]) -> object:
        """Prepared work of the first block of a kind at a prior.

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
            prior: Result of :meth:`predict` for state and memory, where it is known; used up.
        """
        return self.correct(prior or self.predict(state, memory), memory, frame)

    def correct(self, prior: Prior[StateT], memory: Memory, frame: Frame) -> Step[StateT]:
        """Correction of a prior by one frame.

        Args:
            prior: The prediction; its covariance is changed in place.
            memory: Of the frame before.
            frame: The readings.
        """
        prior, decided, notes = self._decided(prior, memory, frame)
        state, points, statements = prior.state, prior.points, []
        self.inflate(state.P, decided)
        for block, at, decision in zip(self.blocks, points, decided, strict=True):
            statements.append(block.linearise(at, decision))
        readings = summed(self.blocks, statements, self.layout)
        posterior = self._updated(state, readings)
        reviews = [(k, block, block.review(posterior, decided[k])) for k, block in self._reviewing]
        if any(decision is not None for _, _, decision in reviews):
            for k, block, decision in reviews:
                if decision is not None:
                    decided[k], statements[k] = decision, block.linearise(points[k], decision)
            readings = summed(self.blocks, statements, self.layout)
            posterior = self._updated(state, readings)
        return self._step(
            posterior, prior, Decisions(prior.noise, decided, notes), readings, statements, memory
        )

    def _step(
        self,
        posterior: StateT,
        prior: Prior[StateT],
        decisions: Decisions,
        readings: Readings,
        statements: Sequence[Statement],
        memory: Memory,
    ) -> Step[StateT]:
        """The step that a frame's decisions and statements led to, from the memory before."""
        decided, points = decisions.blocks, prior.points
        judged = Cached(lambda: self._spreads.judged(memory.spreads, self._spreads.read(decided, statements)))

        def remembered() -> Memory:
            kept = list(memory.blocks)
            for k, block in self._remembering:
                kept[k] = block.remember(posterior, points[k], decided[k], kept[k])
            spreads = judged()[1] if self.follows_spreads else memory.spreads
            return Memory(self.plant.remember(posterior, decisions.notes, memory.plant), kept, spreads)

        return Step(posterior, prior, decisions, readings, Cached(remembered), Cached(lambda: judged()[0]))

    def _decided(
        self, prior: Prior[StateT], memory: Memory, frame: Frame
    ) -> tuple[Prior[StateT], list[Any], Notes]:
        """The prior at which the frame's readings count, the decision of each block, and their notes."""
        notes, blocks = Notes(), zip(self.blocks, prior.points, memory.blocks, strict=True)
        return prior, [block.decide(at, frame, kept, notes) for block, at, kept in blocks], notes

    def inflate(self, P: Array, decided: Sequence[object]) -> None:
        """Adds to a predicted covariance, in place, the process noise that depends on the blocks' decisions."""
        for k, block in self._inflating:
            block.inflate(P, decided[k])

    def linearise(self, state: StateT, decisions: Decisions) -> Readings:
        """A frame's readings, decided before, linearised at another state (for smoothing)."""
        known = zip(self.blocks, self._points(state, None), decisions.blocks, strict=True)
        statements = [block.linearise(at, decision) for block, at, decision in known]
        return summed(self.blocks, statements, self.layout)

    def _updated(self, prior: StateT, readings: Readings) -> StateT:
        P = self.update(prior.P, readings.matrix, readings.rows)
        step = correction(P, readings.vector, readings.rows, readings.values)
        if readings.added is not None:
            step += P @ readings.added
        return self.plant.retract(prior, step, P)
