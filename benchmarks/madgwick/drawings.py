"""The source's figures 26 to 44 drawn again from our own data: Madgwick orange, the Kalman filter blue, truth black."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.madgwick.accuracy import DIRECTION_SDS, Accuracy
from benchmarks.madgwick.behaviour import course, unknown_start, wrapped_euler_deg
from benchmarks.madgwick.measured import Measured
from benchmarks.madgwick.scenes import FOOT, SHOWN_ON, SITTING, THIGH, WALKING, scene, truth_of
from benchmarks.madgwick.third_base import Compared, Sweep
from benchmarks.thesis_report.figures import BLUE, GREEN, GREY, ORANGE, TRUTH, Drawing, axes, labelled, legend
from mbkf.conventions import Array
from mbkf.imu.orientation import euler_angles

if TYPE_CHECKING:
    from matplotlib.axes import Axes

NAMES = ("roll", "pitch", "yaw")
COLOURS = (BLUE, ORANGE, GREEN)
NUMBERS = {
    (WALKING, THIGH): ("32", "33"),
    (WALKING, FOOT): ("34", "35"),
    (SITTING, THIGH): ("36", "37"),
}
"""Figures of each recording: both curves, and their difference; the rest are 38 and 39."""


def drawings(found: Measured) -> Iterator[Drawing]:
    """All figures."""
    yield from _starts()
    if found.second is not None:
        yield _broad(found)
    yield _sweep("30", "First sweep of β and ζ (0.1 to 1)", found.third.first)
    yield _sweep("31", "Second sweep (0.3 to 0.4, 0.01 to 0.1)", found.third.second)
    yield _choice(found.accuracy)
    for one in found.third.compared:
        yield from _both(one)
    yield _wrapped()
    yield from _angles(found.third.compared)


def _starts() -> Iterator[Drawing]:
    """Of a walking thigh, begun at (1, 0, 0, 0) and at its true orientation."""
    one = scene(SHOWN_ON[0], WALKING).sensor(THIGH)
    for number, start, title in (
        ("26", np.array([0.0, 0.0, 0.0, 1.0]), "Unknown start (1, 0, 0, 0)"),
        ("27", truth_of(one)[0], "Start near the first values"),
    ):
        figure, (panel,) = axes()
        _draw_angles(panel, one.time_s, np.degrees(euler_angles(unknown_start(one, 0.1, start))))
        _draw_angles(panel, one.time_s, np.degrees(euler_angles(truth_of(one))), dashed=True)
        yield Drawing(number, f"{title}: Euler angles of a walking thigh", figure, "Dashed: truth; β 0.1.")


def _draw_angles(panel: Axes, time: Array, angles: Array, dashed: bool = False) -> None:
    for column, name, colour in zip(angles.T, NAMES, COLOURS, strict=True):
        label = None if dashed else name
        panel.plot(
            time, column, "--" if dashed else "-", color=colour, lw=0.8 if dashed else 1.1, label=label
        )
    labelled(panel, "time (s)", "angle (deg)")
    if not dashed:
        legend(panel)


def _broad(found: Measured) -> Drawing:
    assert found.second is not None
    one, q = found.second.example
    assert one.orientation is not None
    part = (one.time_s > 60.0) & (one.time_s < 90.0)
    figure, (panel,) = axes()
    _draw_angles(panel, one.time_s[part], wrapped_euler_deg(q[part]))
    known = part & np.isfinite(one.orientation).all(axis=1)
    _draw_angles(panel, one.time_s[known], wrapped_euler_deg(one.orientation[known]), dashed=True)
    return Drawing("28", "Second data base: Euler angles (BROAD)", figure, "Dashed: by cameras; β 0.35.")


def _sweep(number: str, title: str, sweep: Sweep) -> Drawing:
    figure, (panel,) = axes()
    zetas = sorted({zeta for _, zeta, _ in sweep.trials})
    for zeta, colour in zip(
        (zetas[0], zetas[len(zetas) // 2], zetas[-1]), (BLUE, GREEN, ORANGE), strict=True
    ):
        own = sorted((beta, error) for beta, of, error in sweep.trials if of == zeta)
        panel.plot(*zip(*own, strict=True), "o-", ms=3, color=colour, lw=1.0, label=f"ζ {zeta:.2f}")
    panel.plot([sweep.beta], [sweep.error_deg], "*", ms=12, color=TRUTH)
    labelled(panel, "β (rad/s)", "difference (deg)")
    legend(panel)
    return Drawing(number, title, figure, "Walking thigh against the textbook EKF; star: least.")


def _choice(accuracy: Accuracy) -> Drawing:
    figure, (panel,) = axes()
    for (name, curve), colour in zip(accuracy.curve.items(), (BLUE, GREEN, GREY, TRUTH), strict=True):
        panel.semilogx(*zip(*curve, strict=True), "o-", ms=3, color=colour, lw=1.0, label=name)
    panel.axvline(0.35, color=ORANGE, lw=1.0, ls="--")
    labelled(panel, "β (rad/s)", "error against truth (deg)")
    legend(panel)
    note = f"Person 0; dashed: the source's β. The plain EKF was chosen among {len(DIRECTION_SDS)} spreads likewise."
    return Drawing("own", "Choice of β against truth", figure, note)


def _both(one: Compared) -> Iterator[Drawing]:
    upper, lower = NUMBERS.get((one.movement, one.sensor), ("38", "39"))
    title = f"{one.sensor.replace('_', ' ')}, {one.movement}"
    time, own, apart = one.table[:, 0], one.table[:, 1:5], one.table[:, 5:9]
    figure, panels = axes(2, 2, 1.9)
    for panel, k, name in zip(panels, (3, 0, 1, 2), "wxyz", strict=True):
        panel.plot(time, own[:, k], color=BLUE, lw=1.0, label="EKF")
        panel.plot(time, own[:, k] - apart[:, k], color=ORANGE, lw=1.0, label="Madgwick")
        labelled(panel, "time (s)", f"q_{name}")
    legend(panels[1])
    yield Drawing(upper, f"Madgwick and EKF: {title}", figure, "β 0.35, from the EKF's first quaternion.")
    figure, (panel,) = axes()
    for k, name, colour in zip((3, 0, 1, 2), "wxyz", (TRUTH, BLUE, ORANGE, GREEN), strict=True):
        panel.plot(time, apart[:, k], color=colour, lw=0.9, label=f"q{name}")
    labelled(panel, "time (s)", "EKF − Madgwick")
    legend(panel)
    yield Drawing(lower, f"Difference: {title}", figure)


def _wrapped() -> Drawing:
    one = scene(SHOWN_ON[0], WALKING).sensor(THIGH)
    figure, (panel,) = axes()
    panel.plot(one.time_s, np.radians(wrapped_euler_deg(course(one, 0.35))), lw=0.9)
    labelled(panel, "time (s)", "angle (rad)")
    return Drawing("40", "Euler angles as arc tangents give them: walking thigh", figure, "β 0.35.")


def _angles(compared: Sequence[Compared]) -> Iterator[Drawing]:
    """Of the walking and the sitting thigh."""
    for number, beside, movement in (("41", "42", WALKING), ("43", "44", SITTING)):
        one = next(one for one in compared if (one.movement, one.sensor) == (movement, THIGH))
        time, own, apart = one.table[:, 0], np.degrees(euler_angles(one.table[:, 1:5])), one.table[:, 9:12]
        figure, panels = axes(1, 3, 2.4)
        for k, (panel, name) in enumerate(zip(panels, NAMES, strict=True)):
            panel.plot(time, own[:, k], color=BLUE, lw=1.0, label="EKF")
            panel.plot(time, own[:, k] - apart[:, k], color=ORANGE, lw=1.0, label="Madgwick")
            labelled(panel, "time (s)", f"{name} (deg)")
        legend(panels[2])
        yield Drawing(number, f"Euler angles: thigh, {movement}", figure)
        figure, (panel,) = axes()
        _draw_angles(panel, time, apart)
        yield Drawing(beside, f"Difference of Euler angles: thigh, {movement}", figure)
