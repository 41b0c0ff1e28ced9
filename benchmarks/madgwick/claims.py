"""The claims of the source, each with its value, our measurement and a verdict that follows from the numbers.

*Reproduced*: the numbers here say the same. *Differs*: they do not, and the row says why. *Cannot be had*: it needs
data or devices that are not at hand.
"""

from __future__ import annotations

import math
from itertools import pairwise

from benchmarks.madgwick.accuracy import EKF, PLAIN, SOURCE, TUNED
from benchmarks.madgwick.as_printed import printed_noise
from benchmarks.madgwick.first_base import FILTERS, JOINT_ANGLES
from benchmarks.madgwick.measured import Measured
from benchmarks.madgwick.scenes import FOOT, SECONDS, SITTING, STANDING, THIGH, WALKING
from benchmarks.madgwick.second_base import AT_REST, SecondBase
from benchmarks.thesis_report.contents import CANNOT_BE_HAD, Claim, redone

ALIKE = 1.25
"""Ratio up to which two errors are comparable."""

PRECISE_DEG = 5.0
"""Error of an angle below which it counts as precise; the source states no number."""

MEAN_QW = 0.11535
"""The least mean difference of the source's search."""


def claims(found: Measured) -> list[Claim]:
    """All claims, in the order of the source."""
    return [
        *_of_the_filter(found),
        *_advantages(found),
        *_first_base(found),
        *_second_base(found),
        *_third_base(found),
        *_tuning(found),
        *_results(found),
        *_conclusions(found),
    ]


def least_angle_deg(difference: float) -> float:
    """Least turn between two unit quaternions one component of which differs so much: 4 asin(d / 2), degrees."""
    return math.degrees(4.0 * math.asin(0.5 * difference))


def _seconds(time_s: float) -> str:
    return f"{time_s:.2f} s" if math.isfinite(time_s) else f"more than {SECONDS:g} s"


def _of_the_filter(found: Measured) -> list[Claim]:
    b = found.behaviour
    betas = sorted(b.settling_s)
    quicker = all(b.settling_s[one] >= b.settling_s[two] for one, two in pairwise(betas))
    noisier = all(b.jitter_deg[one] < b.jitter_deg[two] for one, two in pairwise(betas))
    settled = ", ".join(
        f"β {beta:g}: {_seconds(b.settling_s[beta])}, {b.jitter_deg[beta]:.2f}°" for beta in betas
    )
    letter, own = b.zeta_change_deg
    second = found.second
    field = "no captures at hand"
    if second is not None:
        field = f"BROAD, two trials: {second.with_field:.1f}° with, {second.without_field:.1f}° without magnetometer"
    return [
        Claim(
            "3.2",
            "A larger β converges faster and brings in more noise; a smaller one is slower and smoother.",
            f"thigh, from (1, 0, 0, 0) to below 5°, and change between samples while standing: {settled}",
            redone(quicker and noisier),
        ),
        Claim(
            "3.2, Madgwick eq. 34",
            "ζ weighs the gyroscope: a larger one gives a smoother, a smaller one a more sensitive output.",
            f"by the letter of Madgwick eq. 34 ζ 0.07 moves the orientation by {letter:.2f}° at most: the correction "
            "is not integrated, so that it does nothing. Integrated (Madgwick 2010) it is an estimate of the bias: "
            f"{own:.1f}°",
            redone(letter > 0.5 * own),
        ),
        Claim(
            "3.2",
            "The magnetometer is optional; used well it improves the results markedly.",
            f"{field} (β 0.35, from the true start)",
            CANNOT_BE_HAD if second is None else redone(second.with_field < 0.8 * second.without_field),
        ),
        Claim(
            "3.2",
            "The filter's steps are Madgwick eqs. 22 to 37.",
            "by the letter, with two misprints of Madgwick eq. 28 put right (third row a_z, last row 2 b_3 (½ − q_1² − "
            f"q_2²)), and by mbkf's filter: {b.printed_deg:.1e}° apart at most",
            redone(b.printed_deg < 1e-6),
        ),
    ]


def _advantages(found: Measured) -> list[Claim]:
    t, a, b = found.times, found.accuracy, found.behaviour
    python = t.madgwick_python < min(t.plain_python, t.ekf_python)
    compiled = not t.madgwick_c >= t.ekf_c
    in_c = "C was not compiled"
    if math.isfinite(t.ekf_c):
        in_c = f"both in C: {t.madgwick_c:.2f} against {t.ekf_c:.2f} µs"
    worse = {name: a.with_worse_sensors[name] / a.overall[name] for name in (TUNED, PLAIN, EKF)}
    off = {name: max(a.wrongly_set[name]) / a.overall[name] for name in (TUNED, PLAIN)}
    return [
        Claim(
            "Summary, 3.3.1, 6",
            "Madgwick's filter needs less computing than the EKF (stated as theory, no number).",
            f"per sample, both in Python: {t.madgwick_python:.0f} µs against {t.plain_python:.0f} (plain EKF) and "
            f"{t.ekf_python:.0f} µs (mbkf's); {in_c}. An earlier row had the EKF at 0.30 of "
            "Madgwick's time, since one ran in C and the other in Python",
            redone(python and compiled),
        ),
        Claim(
            "3.3.2",
            "Quaternions avoid the singularity of Euler angles (Cardan's lock).",
            f"pitch passing 90°: orientation within {b.lock_quaternion_deg:.1f}°, yaw off by up to "
            f"{b.lock_yaw_deg:.0f}°. An EKF on rotations (ours, the plain one) avoids it as well",
            redone(b.lock_quaternion_deg < 5.0 < b.lock_yaw_deg),
        ),
        Claim(
            "3.3.3",
            "It depends less on a precise model than the EKF.",
            "tuned setting wrong by a factor of 4 (the worse way), error over the tuned one: Madgwick "
            f"{off[TUNED]:.2f}, plain EKF {off[PLAIN]:.2f}. β is a model, too: how far to trust gravity",
            redone(off[TUNED] < 0.9 * off[PLAIN]),
        ),
        Claim(
            "Summary, 3.3.4",
            "It is more robust against errors of the sensors, and surpasses the EKF in this.",
            "all errors of the sensors four times as large, error over the usual one: "
            + ", ".join(f"{name} {ratio:.2f}" for name, ratio in worse.items())
            + f"; in degrees {a.with_worse_sensors[TUNED]:.1f}, {a.with_worse_sensors[PLAIN]:.1f} and "
            f"{a.with_worse_sensors[EKF]:.1f} (mbkf's EKF estimates bias and acceleration)",
            redone(a.with_worse_sensors[TUNED] < a.with_worse_sensors[EKF]),
        ),
        Claim(
            "3.3.5",
            "Two gains are easy to adjust.",
            "an opinion on people's work; measured are 3.3.3, and that tuning at rest gives gains that fail in "
            "movement (5.3.2)",
            CANNOT_BE_HAD,
        ),
    ]


def _first_base(found: Measured) -> list[Claim]:
    one, b = found.first, found.behaviour
    return [
        Claim(
            "4.1, figures 9 to 15",
            "Motions of AMASS (HumanEva) become virtual sensors at eight places.",
            f"a made file in AMASS's format: {one.skeleton} joint rotations kept to {one.joints_rad:.0e} rad, eight "
            "sensors, Madgwick, joint angles by command. HumanEva itself: its licence asks each user to register",
            redone(one.joints_rad < 1e-6),
        ),
        Claim(
            "4.1, Madgwick eq. 38",
            "Accelerations are second differences of places.",
            f"{one.acceleration_error_mps2:.2f} m/s² RMS from the exact ones of a walking thigh at 120 Hz",
            redone(one.acceleration_error_mps2 < 0.5),
        ),
        Claim(
            "4.1, Madgwick eqs. 39 to 43",
            "Angular velocities follow from differences of rotation matrices.",
            f"{one.rate_factor:.2f} times the true ones: Madgwick eqs. 41 to 43 add two equal entries and do not "
            f"halve, and Madgwick eq. 40 has the other sign; halved they are right to {100 * one.rate_error:.1f} %",
            redone(abs(one.rate_factor - 1.0) < 0.05),
        ),
        Claim(
            "4.1, figures 16 and 17",
            "Gaussian noise and a constant of random sign make them realistic.",
            "virtual sensors here have white noise, a constant bias and its walk, by a data sheet (ImuErrors); "
            "whether the source's sizes are realistic, its text does not state",
            CANNOT_BE_HAD,
        ),
        Claim(
            "5.1, figures 26 and 27",
            "From an unknown start (1, 0, 0, 0) the result is of no use; one near the first values repairs it.",
            f"walking thigh, ten seconds: {b.unknown_deg[0]:.1f}° from (1, 0, 0, 0), {b.unknown_deg[1]:.1f}° from "
            f"the true start (β 0.35, with magnetometer, {b.settling_s[0.35]:.2f} s to settle)",
            redone(b.unknown_deg[0] > 1.1 * b.unknown_deg[1]),
        ),
    ]


def _second_base(found: Measured) -> list[Claim]:
    second, b = found.second, found.behaviour
    started = ", ".join(f"{name} {value:.1f}°" for name, value in b.start_error_deg.items())
    broad = "" if second is None else f", BROAD {second.start_deg:.1f}°"
    known = max([*b.start_error_deg.values(), *([] if second is None else [second.start_deg])])
    return [
        Claim(
            "4.2, 5.2",
            "The public walks on nine surfaces (Luo et al. 2020): filter run, figure 28; the angles in the files, "
            "figure 29, do not convince.",
            "that set is not among the captures at hand. BROAD stands in: a public set with magnetometers whose "
            "orientations cameras measured, which the source missed",
            CANNOT_BE_HAD,
        ),
        Claim(
            "5.1, 5.3.1, 5.4",
            "The first orientation cannot be had from the sensors; it has to come from another filter.",
            f"it follows from gravity and field of the first readings: {started}{broad} off",
            redone(known > 10.0),
        ),
    ]


def _third_base(found: Measured) -> list[Claim]:
    third = found.third
    return [
        Claim(
            "4.3",
            "Exports of physical data and quaternions become CSV, names padded with blanks, 60 Hz.",
            f"such tables (made here) are read to {third.read:.0e} by imu orient, --compare and --initial compared",
            redone(third.read < 1e-6),
        ),
        Claim(
            "4.3",
            ".capp and .capq are read by two scripts of the author.",
            "binary files of Tech MCS Studio; a description was looked for, and none was found",
            CANNOT_BE_HAD,
        ),
        Claim(
            "4.3",
            "The Tech-IMU computes its quaternions by an EKF.",
            "its filter is not described. A textbook EKF on the same two directions stands for it here, beside mbkf's",
            CANNOT_BE_HAD,
        ),
    ]


def _tuning(found: Measured) -> list[Claim]:
    second, third, a = found.second, found.third, found.accuracy
    noise = printed_noise(0.35)
    first, then, wide = third.first, third.second, third.wide
    at_rest, verdict = "no captures at hand", CANNOT_BE_HAD
    if second is not None:
        verdict = redone(abs(second.beta_at_rest / 0.35 - 1.0) < 0.2)
        at_rest = (
            f"BROAD at rest ({second.noise_deg_s:.2f} °/s): β {second.beta_at_rest:.4f}, ζ {second.zeta_at_rest:.1e} "
            "by Madgwick's √(3/4) σ. Madgwick eqs. 46 and 48 draw the root of the product; of readings in °/s that "
            f"gives β {second.beta_printed_deg:.2f}, ζ {second.zeta_printed_deg:.3f}. β 0.35 is that of {noise:.2f} "
            "°/s, a usual noise: 0.35 seems to come from this misprint and the wrong unit"
        )
    return [
        Claim("5.3.2, Madgwick eqs. 44 to 48", "A still capture gives β 0.35, ζ 0.07.", at_rest, verdict),
        Claim(
            "5.3.2, figure 30",
            "First sweep (0.1 to 1): least mean difference 0.11546 at β 0.34, ζ 0.01.",
            f"walking thigh against a textbook EKF: least at β {first.beta:.2f}, ζ {first.zeta:.2f} "
            f"({first.error_deg:.1f}°), the lower edge; from 0.01 on at β {wide.beta:.2f} ({wide.error_deg:.1f}°). "
            "The optimum depends on the settings of the other filter; it does not show the right β. The sweep does not "
            "contain the point (0.34, 0.01)",
            redone(abs(first.beta - 0.34) < 0.05),
        ),
        Claim(
            "5.3.2, figure 31",
            "Second sweep: least mean difference 0.11535 at β 0.33, ζ 0.05.",
            f"β {then.beta:.2f}, ζ {then.zeta:.2f}, the edges again. By the letter of Madgwick eq. 34 ζ hardly "
            f"matters: the mean difference of q_w is {third.letter[0]:.5f} with ζ 0.01, {third.letter[1]:.5f} with 0.1",
            redone(abs(then.beta - 0.33) < 0.03),
        ),
        Claim(
            "5.3.2",
            "The search confirms the gains of the still capture.",
            f"against the truth: β {a.beta:g} (virtual sensors, chosen on one person)"
            + ("" if second is None else _on_broad(second))
            + ". At rest the gyroscope shows none of the errors that grow with movement, nor accelerations",
            CANNOT_BE_HAD if second is None else redone(abs(second.beta_at_rest / second.beta - 1.0) < 0.3),
        ),
    ]


def _on_broad(second: SecondBase) -> str:
    return (
        f", {second.beta:g} (BROAD); at rest {second.beta_at_rest:.4f}, with which other trials of BROAD err by "
        f"{second.errors[AT_REST]:.1f}° (tuned {second.errors[TUNED]:.1f}°)"
    )


def _results(found: Measured) -> list[Claim]:
    third, b, a = found.third, found.behaviour, found.accuracy
    rows = [
        f"{one.movement}, {one.sensor.replace('_', ' ')}: q_w {one.mean_qw:.3f}, {one.rms_deg:.1f}°"
        for one in third.compared
    ]
    segment = a.by_segment
    of_both = {name: value for name, value in segment.items() if name.endswith(("foot", "thigh"))}
    elsewhere = max(value for name, value in segment.items() if name not in of_both)
    return [
        Claim(
            "5.3.3, figures 32 to 39",
            "Madgwick and the sensor's EKF agree: walking (thigh, foot), sitting down, standing.",
            "mean difference of q_w and RMS angle, β 0.35: "
            + "; ".join(rows)
            + ". The source prints curves, no numbers",
            redone(max(one.mean_qw for one in third.compared) < MEAN_QW),
        ),
        Claim(
            "5.3.3",
            "Thigh and foot are where estimation is hardest.",
            "walking, β 0.35: "
            + ", ".join(f"{name.replace('_', ' ')} {value:.1f}°" for name, value in segment.items())
            + f". Least of thighs and feet {min(of_both.values()):.1f}°, greatest elsewhere {elsewhere:.1f}°",
            redone(min(of_both.values()) > elsewhere),
        ),
        Claim(
            "5.3.3, figure 40",
            "Jumps of 2π vanish by unwrapping.",
            f"largest step between samples {b.wrap_deg:.0f}° before, {b.unwrapped_deg:.0f}° after",
            redone(b.unwrapped_deg < 90.0 < b.wrap_deg),
        ),
        Claim(
            "5.3.2 and 5.4",
            f"A mean difference of {MEAN_QW} is a comparable accuracy.",
            f"where one component differs by that, the two orientations are {least_angle_deg(MEAN_QW):.1f}° apart or "
            "more. A difference between two filters is not the error of one of them",
            redone(least_angle_deg(MEAN_QW) < 5.0),
        ),
    ]


def _conclusions(found: Measured) -> list[Claim]:
    a, t, one, b = found.accuracy, found.times, found.first, found.behaviour
    walking = {name: _walking(found, name) for name in (TUNED, SOURCE, PLAIN, EKF)}
    quiet = max(
        a.by_movement[SOURCE, movement, sensor]
        for movement in (SITTING, STANDING)
        for sensor in (THIGH, FOOT)
    )
    angles = {name: max(one.angle_rms_deg[name, joint] for joint in JOINT_ANGLES) for name in FILTERS}
    slow = max(t.madgwick_python, t.plain_python)
    return [
        Claim(
            "5.4, 6",
            "Madgwick's accuracy is comparable to the EKF's (β 0.35, against a sensor's EKF).",
            f"overall {a.overall[SOURCE]:.1f}° with the source's gains; tuned (β {a.beta:g}) "
            f"{a.overall[TUNED]:.1f}°, plain EKF {a.overall[PLAIN]:.1f}°, mbkf's {a.overall[EKF]:.1f}°. Walking: "
            f"{walking[SOURCE]:.1f}, {walking[TUNED]:.1f}, {walking[PLAIN]:.1f} and {walking[EKF]:.1f}°; sitting "
            f"down and standing at most {quiet:.1f}° with the source's gains. Over an EKF on the same two directions: "
            f"{a.overall[SOURCE] / a.overall[PLAIN]:.1f} times the error with β 0.35, which follows a walking leg's "
            f"accelerations, {a.overall[TUNED] / a.overall[PLAIN]:.1f} times once β is tuned (up to {ALIKE:g} "
            "counts as comparable). mbkf's EKF tells acceleration from gravity",
            redone(a.overall[SOURCE] < ALIKE * a.overall[PLAIN]),
        ),
        Claim(
            "5.4",
            "The largest errors are in Euler angles, by errors that pile up in the conversion.",
            f"there and back changes a quaternion by {b.round_trip:.0e}: nothing piles up. Angles in degrees are "
            "larger numbers than q, and roll and yaw grow without bound as pitch nears 90°",
            redone(b.round_trip > 1e-3),
        ),
        Claim(
            "1.1, 5.4, 6",
            "Fit for real time on small devices.",
            f"at 60 Hz a sample may take 16,667 µs; in Python it takes {t.madgwick_python:.0f} µs (plain EKF "
            f"{t.plain_python:.0f}), so that the EKF is fit for it, too",
            redone(slow < 1e6 / 60.0),
        ),
        Claim(
            "6",
            "Precise and stable angles of the lower limb.",
            "largest RMS of hip, knee and ankle flexion, walking, eight sensors: "
            + ", ".join(f"{name} {value:.1f}°" for name, value in angles.items())
            + f" (β 0.1; the joints hold headings together); below {PRECISE_DEG:g}° counts as precise",
            redone(angles["madgwick"] < PRECISE_DEG),
        ),
        Claim(
            "1.2, 6",
            "For patients with an exoskeleton.",
            "no patient and no exoskeleton was recorded, in the source either",
            CANNOT_BE_HAD,
        ),
        Claim(
            "1.3",
            "Noise on synthetic data makes the model more robust.",
            "a filter learns nothing from its input; noise only shows how robust it is (3.3.4)",
            CANNOT_BE_HAD,
        ),
        Claim(
            "3.1.2",
            "Error-state, unscented, variable and complementary Kalman filters, each with its advantage.",
            "taken from other texts and not run in the source; the EKF here is an error-state filter",
            CANNOT_BE_HAD,
        ),
    ]


def _walking(found: Measured, name: str) -> float:
    errors = found.accuracy.by_movement
    return float(((errors[name, WALKING, THIGH] ** 2 + errors[name, WALKING, FOOT] ** 2) / 2.0) ** 0.5)
