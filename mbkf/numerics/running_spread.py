"""The spread of readings as their own past shows it: a running mean square, known before the next reading comes.

    n ← n + 1,   σ² ← σ² + max(1/n, 1 − e^(−Δt/T)) (mean y² − σ²)

is the mean of all y² so far, and after T that of the last T. It starts at an expected spread that counts as n₀ frames
(Mehra 1970 estimates R and Q from innovations in this way). Normalised by σ² of the frames
before, y² has mean one as long as the spread stays what it was and within its range: y_k does not enter its own σ².
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array, BoolArray


class RunningSpread(NamedTuple):
    """Mean squares of channels (n,), and the frames (n,) that each rests on: n₀ at first, 0 where nothing is known."""

    mean_square: Array
    frames: Array

    def followed(self, mean_square: Array, seen: BoolArray, forget: float) -> RunningSpread:
        """After a frame.

        Args:
            mean_square: (n,) mean of the squares of the frame's readings, by channel; any finite number where not seen.
            seen: (n,) channels that read.
            forget: 1 − e^(−Δt/T).
        """
        frames = self.frames + seen
        gain = np.maximum(1.0 / np.maximum(frames, 1.0), forget) * seen
        return RunningSpread(self.mean_square + gain * (mean_square - self.mean_square), frames)
