"""What the thesis says of whole bodies (its 4.2 and chapter 5), each statement with its measurement and a verdict.

The thesis's filter is FDMC with the covariances of its Table 4.3. Read as the thesis's equations have them, as
densities, it loses quick movements; read as what one frame adds ("per frame") it behaves as the thesis describes it. So
the verdicts are on that form unless the statement is about losing trials; mbkf's own filters stand beside it.
"""

from __future__ import annotations

from collections.abc import Sequence

from benchmarks.full_body.accuracy import trial_count
from benchmarks.full_body.filters import DYNAMIC, FCDI, FDMC, FDMC_PER_FRAME, FDMC_PRINTED
from benchmarks.full_body.survey import Survey
from benchmarks.full_body.trials import BESIDE, GENERAL, HEAVY, JUMP, LOST, MOVEMENTS, SQUAT
from benchmarks.thesis_report.contents import CANNOT_BE_HAD, Claim, judged

SHOWN = (FCDI, FDMC_PER_FRAME, FDMC, DYNAMIC)
"""Filters whose numbers stand beside a claim."""

ALIKE = 0.15
"""Two numbers whose ratio is this close to 1 are alike."""

MARKED = 1.5
"""What grows by this factor differs markedly."""


def survey_claims(found: Survey) -> list[Claim]:
    """The claims that the synthetic trials decide."""
    return [
        *_general_claims(found),
        *_squat_claims(found),
        *_lost_marker_claims(found),
        *_jump_claims(found),
        *_conclusions(found),
    ]


def beside(found: Survey, movement: str, number: str, unit: str, names: Sequence[str] = SHOWN) -> str:
    """The number of several filters over their common trials of a movement, in words.

    Args:
        found: All outcomes.
        movement: The movement.
        number: A field of the scores.
        unit: Its unit.
        names: The filters.
    """
    same = found.common(names, movement)
    return ", ".join(f"{name} {same.pooled(name, movement, number):.3g} {unit}".rstrip() for name in names)


def _over_fcdi(found: Survey, movement: str, number: str, name: str = FDMC_PER_FRAME) -> float:
    return found.ratio(name, [FCDI], movement, number)


def _lost(found: Survey, name: str, movements: Sequence[str]) -> str:
    lost = sum(found.divergences(name, movement) for movement in movements)
    return f"{name} {lost} of {trial_count(found, name, movements)}"


def _general_claims(found: Survey) -> list[Claim]:
    both = (GENERAL, SQUAT)
    printed = sum(found.divergences(FDMC_PRINTED, movement) for movement in both)
    per_frame = sum(found.divergences(FDMC_PER_FRAME, movement) for movement in both)
    names = (FDMC_PRINTED, FDMC_PER_FRAME, FDMC, DYNAMIC)
    angle, delay = (_over_fcdi(found, GENERAL, key) for key in ("angle_deg", "velocity_delay_ms"))
    both_late = found.common((FDMC_PER_FRAME, FCDI), GENERAL)
    noise, torque_noise = (
        _over_fcdi(found, GENERAL, key) for key in ("velocity_noise_rad_s", "torque_noise_nm")
    )
    late = [both_late.pooled(name, GENERAL, "torque_delay_ms") for name in (FDMC_PER_FRAME, FCDI)]
    on, off = (found.common(SHOWN, movement) for movement in (GENERAL, BESIDE))
    residual = {
        name: [
            part.pooled(name, movement, "residual_everywhere_n")
            for part, movement in ((on, GENERAL), (off, BESIDE))
        ]
        for name in SHOWN
    }
    grown = residual[FCDI][1] / residual[FCDI][0]
    held = residual[FDMC_PER_FRAME][1] < residual[FCDI][1]
    return [
        Claim(
            "Table 4.3",
            "One set of covariances, scaled with the mass, reconstructs general movement and squat of all subjects.",
            "lost: " + ", ".join(_lost(found, name, both) for name in names),
            judged(printed == 0 and per_frame == 0, per_frame == 0),
        ),
        Claim(
            "Figure 4.4",
            "General movement: FDMC and FCDI estimate angles alike.",
            beside(found, GENERAL, "angle_deg", "°"),
            judged(abs(angle - 1.0) < ALIKE),
        ),
        Claim(
            "Figure 4.5",
            "The dynamic model reduces the delay of velocities.",
            beside(found, GENERAL, "velocity_delay_ms", "ms"),
            judged(abs(delay) < 1.0),
        ),
        Claim(
            "Figure 4.5",
            "It brings noise into the velocities.",
            beside(found, GENERAL, "velocity_noise_rad_s", "rad/s"),
            judged(noise > 1.0),
        ),
        Claim(
            "Figure 4.6",
            "Torques of FDMC have less noise than those of FCDI.",
            beside(found, GENERAL, "torque_noise_nm", "N m"),
            judged(torque_noise < 1.0),
        ),
        Claim(
            "Figure 4.6",
            "In return they are delayed.",
            beside(found, GENERAL, "torque_delay_ms", "ms"),
            judged(late[0] > late[1]),
        ),
        Claim(
            "Figure 4.7",
            "The residual grows when a plate is missing, which shows that FDMC is the more precise one.",
            "with and without the plate: "
            + ", ".join(
                f"{name} {with_:.3g} and {without:.3g} N" for name, (with_, without) in residual.items()
            ),
            judged(grown > MARKED and held, grown > MARKED),
        ),
    ]


def _squat_claims(found: Survey) -> list[Claim]:
    angle, torque = (_over_fcdi(found, SQUAT, key) for key in ("angle_deg", "torque_nm"))
    noisier = _over_general(found, FDMC_PER_FRAME, "velocity_noise_rad_s")
    noise = _over_fcdi(found, SQUAT, "torque_noise_nm")
    same = found.common((FDMC_PER_FRAME, FCDI), SQUAT)
    late = [same.pooled(name, SQUAT, "torque_delay_ms") for name in (FDMC_PER_FRAME, FCDI)]
    smaller = [_over_general(found, name, "residual_everywhere_n") for name in (FCDI, FDMC_PER_FRAME)]
    return [
        Claim(
            "Figure 4.9",
            "Squat: angles of both filters are alike.",
            beside(found, SQUAT, "angle_deg", "°"),
            judged(abs(angle - 1.0) < ALIKE),
        ),
        Claim(
            "Figure 4.10",
            "Squat: velocities are markedly noisier than in the general movement.",
            f"FDMC per frame, squat over general movement: {noisier:.2f}",
            judged(noisier > MARKED, noisier > 1.0),
        ),
        Claim(
            "Figure 4.11",
            "Squat: torques of both are alike and acceptable.",
            beside(found, SQUAT, "torque_nm", "N m"),
            judged(abs(torque - 1.0) < ALIKE),
        ),
        Claim(
            "Figure 4.11",
            "Squat: FCDI's torques are noisier, FDMC's later.",
            "noise "
            + beside(found, SQUAT, "torque_noise_nm", "N m")
            + "; delay "
            + beside(found, SQUAT, "torque_delay_ms", "ms"),
            judged(noise < 1.0 and late[0] > late[1], noise < 1.0 or late[0] > late[1]),
        ),
        Claim(
            "Figure 4.12",
            "The residual of squats is smaller than that of the general movement, as both feet stay on plates.",
            f"squat over general movement: FCDI {smaller[0]:.2f}, FDMC per frame {smaller[1]:.2f}",
            judged(max(smaller) < 1.0, min(smaller) < 1.0),
        ),
    ]


def _over_general(found: Survey, name: str, number: str) -> float:
    """A number in squats over the same in the general movement, of the same persons and seeds."""
    both = [found.common(SHOWN, movement).pooled(name, movement, number) for movement in (SQUAT, GENERAL)]
    return both[0] / both[1]


def _lost_marker_claims(found: Survey) -> list[Claim]:
    knee = _over_fcdi(found, LOST, "knee_deg")
    torque = {name: _against_squat(found, name, "knee_torque_nm") for name in SHOWN}
    lateral = {name: _against_squat(found, name, "knee_lateral_nm") for name in SHOWN}
    better = {name: _wins(found, name) for name in (FDMC_PER_FRAME, FDMC, DYNAMIC)}
    mixed = [0.1 * of <= won <= 0.9 * of for won, of in (better[FDMC_PER_FRAME], better[FDMC])]
    several = all(of > 1 for _, of in better.values())
    told = ", ".join(f"{name} in {own} of {all_} trials" for name, (own, all_) in better.items())
    return [
        Claim(
            "Figure 4.13",
            "Squat with the knee markers lost for 100 frames: FDMC estimates the knee better than FCDI.",
            "at the worst: " + beside(found, LOST, "knee_deg", "°"),
            judged(knee < 0.9, knee < 1.0),
        ),
        Claim(
            "Figure 4.14",
            "Its forces deviate strongly when the markers go and come back.",
            "knee flexion torque, error over that without loss: "
            + ", ".join(f"{name} {ratio:.2f}" for name, ratio in torque.items()),
            judged(torque[FDMC_PER_FRAME] > MARKED, torque[FDMC_PER_FRAME] > 1.1),
        ),
        Claim(
            "Figure 4.14",
            "The knee's lateral torque differs markedly in both filters.",
            "error over that without loss: "
            + ", ".join(f"{name} {ratio:.2f}" for name, ratio in lateral.items()),
            judged(
                min(lateral[FCDI], lateral[FDMC_PER_FRAME]) > MARKED,
                max(lateral[FCDI], lateral[FDMC_PER_FRAME]) > MARKED,
            ),
        ),
        Claim(
            "4.2, squat",
            "Which filter is more robust against lost markers depends on the case.",
            f"knee better than FCDI's: {told}" + ("" if several else "; one trial shows one case"),
            judged(all(mixed), any(mixed)) if several else CANNOT_BE_HAD,
        ),
    ]


def _against_squat(found: Survey, name: str, number: str) -> float:
    """A number with the markers lost over the same without, of the same persons and seeds."""
    both = [found.common(SHOWN, movement).pooled(name, movement, number) for movement in (LOST, SQUAT)]
    return both[0] / both[1]


def _wins(found: Survey, name: str) -> tuple[int, int]:
    """In how many squats with lost markers the knee is better than FCDI's, and of how many."""
    theirs = {(one.person, one.seed): one.scores.knee_deg for one in found.of(FCDI, LOST)}
    own = [(one.scores.knee_deg, theirs[one.person, one.seed]) for one in found.of(name, LOST)]
    return sum(a < b for a, b in own), len(own)


def _jump_claims(found: Survey) -> list[Claim]:
    names = (FDMC_PRINTED, FDMC_PER_FRAME, FDMC, DYNAMIC, FCDI)
    lost, jumps = found.divergences(FDMC_PRINTED, JUMP), len(found.of(FDMC_PRINTED, JUMP))
    steady = _over_fcdi(found, JUMP, "torque_noise_nm")
    return [
        Claim(
            "4.2, jump",
            "With the common covariances most jumps cannot be reconstructed.",
            "lost: " + ", ".join(_lost(found, name, (JUMP,)) for name in names),
            judged(2 * lost > jumps, lost > 0),
        ),
        Claim(
            "Figure 4.15",
            "Where a jump is reconstructed the torques stay stable in spite of its violence.",
            "noise of the legs' torques: " + beside(found, JUMP, "torque_noise_nm", "N m"),
            judged(steady < 1.0),
        ),
    ]


def _conclusions(found: Survey) -> list[Claim]:
    angle = [_over_fcdi(found, movement, "angle_deg") for movement in MOVEMENTS]
    torque = [_over_fcdi(found, movement, "torque_nm") for movement in MOVEMENTS]
    ours = [_over_fcdi(found, movement, "torque_nm", DYNAMIC) for movement in MOVEMENTS]
    late = {
        name: [
            found.common((FDMC_PER_FRAME, FCDI), movement).pooled(name, movement, "velocity_delay_ms")
            for movement in MOVEMENTS
        ]
        for name in (FDMC_PER_FRAME, FCDI)
    }
    less = [abs(own) < 0.7 * theirs for own, theirs in zip(*late.values(), strict=True)]
    knee = {name: _over_fcdi(found, LOST, "knee_deg", name) for name in (FDMC_PER_FRAME, FDMC, DYNAMIC)}
    heavy = {name: _over_fcdi(found, HEAVY, "torque_nm", name) for name in (FDMC_PER_FRAME, FDMC, DYNAMIC)}
    return [
        Claim(
            "Chapter 5",
            "Positions of both approaches are practically identical.",
            f"RMS error of the angles, FDMC per frame over FCDI, by movement: {_span(angle)}",
            judged(max(abs(r - 1.0) for r in angle) < ALIKE, sum(abs(r - 1.0) < ALIKE for r in angle) >= 3),
        ),
        Claim(
            "Chapter 5",
            "Dynamics inside the filter does not improve the estimated forces substantially.",
            f"RMS error of the torques over FCDI's, by movement: FDMC per frame {_span(torque)}, "
            f"dynamic {_span(ours)}",
            judged(min(torque) > 0.85 and min(ours) > 0.85, min(torque) > 0.85),
        ),
        Claim(
            "Chapter 5",
            "It makes the capture considerably more robust against lost markers.",
            "knee at the worst over FCDI's: "
            + ", ".join(f"{name} {ratio:.2f}" for name, ratio in knee.items()),
            judged(knee[FDMC_PER_FRAME] <= 0.7, knee[DYNAMIC] <= 0.7),
        ),
        Claim(
            "Chapter 5",
            "It reduces the delay of velocities considerably, and may add noise.",
            "velocity delay in ms, by movement: "
            + ", ".join(f"{name} {_span(values, 1)}" for name, values in late.items()),
            judged(all(less), any(less)),
        ),
        Claim(
            "Chapter 5",
            "With errors of the model the dynamic filter gives the better estimates.",
            "torque error with a mass 5 % too large, over FCDI's: "
            + ", ".join(f"{name} {ratio:.2f}" for name, ratio in heavy.items()),
            judged(heavy[FDMC_PER_FRAME] < 1.0, heavy[DYNAMIC] < 1.0),
        ),
    ]


def _span(values: Sequence[float], decimals: int = 2) -> str:
    return f"{min(values):.{decimals}f} … {max(values):.{decimals}f}".replace("-", "−")
