"""The verdict as a pure function of the evidence, and the frames that it leaves."""

from __future__ import annotations

from dataclasses import replace

from mbkf.io.results import Reconstruction
from mbkf.io.verdict import Verdict
from mbkf.trial.verdict.evidence import Evidence, evidence_of
from mbkf.trial.verdict.load_reasons import check_reasons, load_reasons
from mbkf.trial.verdict.motion_reasons import motion_reasons


def judge(evidence: Evidence) -> Verdict:
    """The verdict on a trial; equal evidence gives equal verdicts, from whatever way in.

    Args:
        evidence: The evidence.
    """
    motion = [*motion_reasons(evidence), *check_reasons(evidence)]
    return Verdict.of([*motion, *load_reasons(evidence, motion)])


def judged_result(r: Reconstruction) -> Reconstruction:
    """The result with its verdict; where loads are not to be used, no frame is valid.

    Args:
        r: The result, with its checks.
    """
    verdict = judge(evidence_of(r))
    return replace(r, verdict=verdict, valid=r.valid & verdict.loads_usable)


def verdict_of(r: Reconstruction) -> Verdict:
    """The verdict of a result; that of an older file is judged from what the file holds.

    Args:
        r: The result.
    """
    return judge(evidence_of(r)) if r.verdict is None else r.verdict
