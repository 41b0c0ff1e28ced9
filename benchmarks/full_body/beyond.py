"""Statements of the thesis on whole bodies that nothing here can test, each with the reason."""

from __future__ import annotations

from benchmarks.thesis_report.contents import CANNOT_BE_HAD, Claim

_REASONS = (
    (
        "2.3",
        "A UKF is more accurate than the EKF, at a cost that real time forbids.",
        "cited, not measured there; mbkf has no UKF",
    ),
    (
        "3.3.3",
        "Cameras have 0.02 mm of noise, plates 0.3 N, and markers move on the skin by 5 to 20 mm.",
        "captures of the thesis's laboratory are not public; the studies here take these numbers",
    ),
    (
        "3.3.4",
        "Ratios of computing times on the pendulum carry over to the whole body.",
        "the thesis times FDMC alone on the whole body, no other combination",
    ),
    (
        "4.1.1",
        "Of the methods of minimisation that were tried, Levenberg–Marquardt works best.",
        "the others are not named",
    ),
    (
        "4.1.4",
        "Dynamics of the toes make the integration unstable.",
        "toes have no dynamics in mbkf's torque filter either, as the thesis decides",
    ),
    (
        "4.2",
        "Results on eight persons of 26 ± 6 years and 67 ± 18 kg.",
        "their captures are not public; eight made persons of the same ages and masses stand in for them",
    ),
    (
        "4.2, squats",
        "FDMC is the more robust where markers are lost at changes of direction.",
        "no count is given there; the markers of the knee are lost at the bottom of the squat here (Figure 4.13)",
    ),
    (
        "4.2.1",
        "Translated from Matlab to C the kinematic filter runs 65 % faster, the dynamic one 60 %.",
        "there is no Matlab code; Table 4.4 sets its speeds beside ours",
    ),
)


def claims_beyond_reach() -> list[Claim]:
    """The statements, with reasons in place of measurements."""
    return [Claim(source, statement, reason, CANNOT_BE_HAD) for source, statement, reason in _REASONS]
