"""Numbers that the paper prints (docs/references.md, key ``stride``), and its settings."""

from __future__ import annotations

from dataclasses import replace

from mbkf.imu.key_points import NOISY_WEIGHTS, USUAL_WEIGHTS, KeyPointSettings, as_printed

FINAL_M = {"clean": 0.32, "noise": 0.49, "drift": 0.47, "noise and drift": 0.64}
MEAN_M = {"clean": 0.06, "noise": 0.14, "drift": 0.12, "noise and drift": 0.32}
"""Errors of its one signal per case."""

LAST_POSITION_M = {"clean": 1.671, "noise": 1.502, "drift": 1.53, "noise and drift": 1.354}
"""Last estimated position as the data tips of figures 5 to 8 show it; the true one is 2."""

BOTH = "noise and drift"

WINDOW, RATE_HZ, SAMPLES, WINDOWS = 10, 50.0, 248, 24

STEPS_M: dict[str, tuple[float, ...]] = {"one step": (0.70,), "two steps": (0.50, 0.70)}
STEPS_ESTIMATED_M = {"one step": 0.65, "two steps": 1.12}
"""Its two real recordings: lengths, and the final position that it estimates."""

STEP_S, REST_S, FIRST_REST_S = 1.1, 1.1, 1.2
"""Times that its figure 10 shows: a step, the rest after it, and the rest before the first one."""

ALIGNED, AS_STUDIED = 0, 1
"""First sample of the first window: windows that begin with the motion; and where the paper's windows lie, whose 248
samples are second differences of 250 positions, so that the first sample belongs to the second position."""


def weights(case: str) -> tuple[float, float, float]:
    """The paper's weights for a simulated case.

    Args:
        case: Name of the case.
    """
    return NOISY_WEIGHTS if case == BOTH else USUAL_WEIGHTS


def simulated(case: str, first: int = AS_STUDIED) -> KeyPointSettings:
    """The paper's settings on its simulated signals: low pass and bias belong to the real ones.

    Args:
        case: Name of the simulated case.
        first: First sample of the first window.
    """
    return replace(as_printed(weights(case)), first=first, still_s=0.0, low_pass_hz=None)
