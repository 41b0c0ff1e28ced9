"""The source's second data base: a public set with magnetometers, here BROAD, whose truth was measured by cameras.

The source took walks on nine surfaces (Luo et al., Sci. Data 7, 219, 2020), which are not among the captures at hand,
and gave them up because the angles in them did not convince. In BROAD a hand moves a
board; cameras give its true orientations, which the source's set lacks.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.madgwick.accuracy import EKF, SOURCE, THEIRS, TUNED
from benchmarks.madgwick.as_printed import printed_gains
from mbkf.conventions import Array
from mbkf.imu.madgwick import MadgwickSettings
from mbkf.imu.orientation import OrientSettings, orientations
from mbkf.imu.orientation_error import OrientationError, orientation_error
from mbkf.imu.tuning import static_gains, still_stretch
from mbkf.io.imu.files import read_imu
from mbkf.io.imu.readings import ImuReadings

CHOSEN_TRIAL = "16_undisturbed_fast_translation_B.mat"
SHOWN_TRIALS = ("21_undisturbed_fast_combined.mat", "05_undisturbed_slow_rotation_with_breaks_B.mat")
BETAS = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.35)
AT_REST = "Madgwick, gains at rest"
ZETAS = (0.0, 1e-3, 1e-2, 7e-2)


@dataclass(frozen=True)
class SecondBase:
    """Results; errors are root mean squares over the movement phases that the files mark, degrees.

    Attributes:
        beta, zeta: Gains of least error on :data:`CHOSEN_TRIAL`.
        curves: By ζ the (β, error) of the choice.
        errors: By name of the filter, over the trials shown.
        with_field, without_field: Error of the source's β from the true start, with and without magnetometer.
        start_deg: Error of the start by the first readings, largest of the trials.
        noise_deg_s: Noise of the resting gyroscope, root mean square over the trials.
        beta_at_rest, zeta_at_rest: Gains of Madgwick's own formulas at rest.
        beta_printed, beta_printed_deg: β by Madgwick eq. 46 as printed, of readings in rad/s and in °/s.
        zeta_printed, zeta_printed_deg: ζ by Madgwick eq. 48 likewise.
        example: The trial that is drawn, the true orientations and the source's filter on it.
    """

    beta: float
    zeta: float
    curves: dict[float, list[tuple[float, float]]]
    errors: dict[str, float]
    with_field: float
    without_field: float
    start_deg: float
    noise_deg_s: float
    beta_at_rest: float
    zeta_at_rest: float
    beta_printed: float
    beta_printed_deg: float
    zeta_printed: float
    zeta_printed_deg: float
    example: tuple[ImuReadings, Array]


def measure_second_base(data: Path) -> SecondBase:
    """Reads three trials of BROAD and runs the filters on them."""
    (chosen,), shown = (
        read_imu(data / "imu_broad" / CHOSEN_TRIAL),
        [read_imu(data / "imu_broad" / name)[0] for name in SHOWN_TRIALS],
    )
    curves = {
        zeta: [(beta, _deg(_error(chosen, MadgwickSettings(beta, zeta)).total)) for beta in BETAS]
        for zeta in ZETAS
    }
    zeta, beta = min(
        ((zeta, beta) for zeta in ZETAS for beta in BETAS), key=lambda pair: dict(curves[pair[0]])[pair[1]]
    )
    gains = [static_gains(one, *still_stretch(one)) for one in shown]
    still = [one.angular_velocity_rad_s[slice(*still_stretch(one))] for one in shown]
    letter = [printed_gains(rates, one.rate_hz) for rates, one in zip(still, shown, strict=True)]
    letter_deg = [
        printed_gains(np.degrees(rates), one.rate_hz) for rates, one in zip(still, shown, strict=True)
    ]
    rest = MadgwickSettings(_mean([one.beta for one in gains]), _mean([one.zeta for one in gains]))
    errors = {
        TUNED: _pooled(shown, MadgwickSettings(beta, zeta)),
        SOURCE: _pooled(shown, MadgwickSettings(THEIRS.beta)),
        AT_REST: _pooled(shown, rest),
        EKF: _pooled(shown, None),
    }
    return SecondBase(
        beta,
        zeta,
        curves,
        errors,
        _from_truth(shown, True),
        _from_truth(shown, False),
        max(_start_deg(one) for one in shown),
        _deg(float(np.sqrt(np.mean([one.gyro_noise_rad_s**2 for one in gains])))),
        rest.beta,
        rest.zeta,
        _mean([one.beta for one in letter]),
        _mean([one.beta for one in letter_deg]),
        _mean([one.zeta for one in letter]),
        _mean([one.zeta for one in letter_deg]),
        (shown[0], _course(shown[0], MadgwickSettings(THEIRS.beta))),
    )


def _course(
    one: ImuReadings, gains: MadgwickSettings | None, field: bool = True, start: Array | None = None
) -> Array:
    settings = OrientSettings("ekf" if gains is None else "madgwick", field, gains or MadgwickSettings())
    return orientations([one], frame="ENU", settings=settings, start=start)[0].quaternion


def _error(
    one: ImuReadings, gains: MadgwickSettings | None, field: bool = True, start: Array | None = None
) -> OrientationError:
    assert one.orientation is not None
    return orientation_error(_course(one, gains, field, start), one.orientation, one.moving)


def _pooled(shown: list[ImuReadings], gains: MadgwickSettings | None) -> float:
    return _deg(float(np.sqrt(np.mean([_error(one, gains).total ** 2 for one in shown]))))


def _from_truth(shown: list[ImuReadings], field: bool) -> float:
    """Of the source's β from the first true orientation, which a filter without field needs for its heading."""
    errors = []
    for one in shown:
        assert one.orientation is not None
        known = one.orientation[np.isfinite(one.orientation).all(axis=1)]
        errors.append(_error(one, MadgwickSettings(THEIRS.beta), field, known[:1]).total)
    return _deg(float(np.sqrt(np.mean(np.square(errors)))))


def _start_deg(one: ImuReadings) -> float:
    """At the first sample of which the cameras tell the truth, within the first second."""
    assert one.orientation is not None
    first = int(np.flatnonzero(np.isfinite(one.orientation).all(axis=1))[0])
    early = slice(first, first + 1)
    course = _course(one.at(one.time_s[: first + 2], lambda values, _: values[: first + 2]), THEIRS)
    return _deg(orientation_error(course[early], one.orientation[early]).total)


def _mean(values: list[float]) -> float:
    return float(np.mean(values))


def _deg(angle: float) -> float:
    return float(np.degrees(angle))
