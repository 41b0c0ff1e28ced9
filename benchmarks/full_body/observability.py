"""Observability of torques and reactions (thesis 4.1.4.2): four ranks, by the filter's own parts."""

from __future__ import annotations

from benchmarks.thesis_report.contents import Band, Claim, Findings, Row, Sheet, judged
from mbkf.model.protocol import load_protocol
from mbkf.trial.filter_observability import COMPLETE, CUT, SIMPLIFIED, FilterObservability, check_filter
from mbkf.trial.preparation.presets import with_preset
from mbkf.trial.preparation.settings import ReconstructSettings

PROTOCOL = "reference36"
PRESET = "FDMC-literal"
"""The thesis's own state: torques and reactions as they are."""

STATES, UNREAD, REACTIONS = 166, 154, 12
"""The state; its rank without plates; and the readings of two plates."""

KINEMATIC = 2 * 52 + REACTIONS
"""The rank where forces do not move anything: positions, velocities and the plates' readings."""

WITH_PLATES, WITHOUT = "a plate under each foot", "no plates"


def observability_findings() -> Findings:
    """Ranks of [H; HF; HF²; …] with and without plates, for each F."""
    settings, protocol = with_preset(ReconstructSettings(), PRESET), load_protocol(PROTOCOL)
    found = {
        WITH_PLATES: check_filter(protocol, settings),
        WITHOUT: check_filter(protocol, settings, without=["both"]),
    }
    least = {key: {name: _least(check, name) for name in check.variants} for key, check in found.items()}
    expected = [
        (WITH_PLATES, COMPLETE, STATES),
        (WITH_PLATES, SIMPLIFIED, STATES),
        (WITH_PLATES, CUT, KINEMATIC),
        (WITHOUT, COMPLETE, UNREAD),
        (WITHOUT, SIMPLIFIED, UNREAD),
    ]
    bands = [
        Band(
            "observability of torques",
            f"{name}, {plates}: rank of {STATES}",
            least[plates][name],
            rank,
            rank,
            needs_all_seeds=False,
        )
        for plates, name, rank in expected
    ]
    rows: list[Row] = [
        (plates, name, one.reading_rank, one.rank, *one.gap)
        for plates, check in found.items()
        for name in (COMPLETE, SIMPLIFIED, CUT)
        for one in check.variants[name]
    ]
    columns = ("plates", "F", "rank of H", "rank of [H; HF; …]", "least counted", "greatest not counted")
    note = (
        f"Protocol {PROTOCOL}, state of {PRESET}: standing still, and four bent postures in motion. Singular values in "
        "standard deviations of all readings over 0.1 s, a typical size along a direction."
    )
    sheet = Sheet("observability", "Observability of the state with torques", columns, tuple(rows), note)
    return Findings(bands, [sheet], _claims(least))


def _least(check: FilterObservability, name: str) -> int:
    """Least rank over all operating points."""
    return min(one.rank for one in check.variants[name])


def _claims(least: dict[str, dict[str, int]]) -> list[Claim]:
    on, off = least[WITH_PLATES], least[WITHOUT]
    return [
        Claim(
            "4.1.4.2",
            "The rank (thesis eq. 4.14) shows whether a combination of force sensors determines the torques.",
            f"rank {on[COMPLETE]} of {STATES} with a plate under each foot, {off[COMPLETE]} without plates",
            judged(on[COMPLETE] == STATES and off[COMPLETE] == STATES - REACTIONS),
        ),
        Claim(
            "4.1.4.2",
            "With ∂z̈/∂T_e alone, and all other derivatives of z̈ zero (thesis eq. 4.15), the system stays observable.",
            f"rank {on[SIMPLIFIED]} of {STATES}",
            judged(on[SIMPLIFIED] == STATES),
        ),
        Claim(
            "4.1.4.2",
            "∂z̈/∂T_e is the only block of F that cannot be left out.",
            f"rank {on[CUT]} of {STATES} without it",
            judged(on[CUT] < STATES == on[SIMPLIFIED]),
        ),
    ]
