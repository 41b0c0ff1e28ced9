"""The thesis's correction of marker places on one person."""

import numpy as np
import pytest

from benchmarks.dynamic.methods import in_turn
from benchmarks.full_body import placement
from benchmarks.full_body.placement import Placement, measure_placement, placement_findings
from mbkf.model.protocol import load_protocol
from mbkf.synthesis.person import synthesise_subject
from mbkf.trial.observability import followed_markers
from tests.motions import reference_model


def test_the_correction_takes_the_constant_part_of_the_distance_away():
    found = measure_placement(0)
    assert found.person == "W 22, 49.75 kg"
    assert found.after_mm < 0.6 * found.before_mm


def test_markers_in_place_have_no_distance_and_their_own_places():
    model, subject = reference_model(), synthesise_subject(0)
    names = tuple(one.name for one in followed_markers(load_protocol(subject.protocol)))
    printed = placement._protocol_places(subject, model, names)
    away, local = placement._fitted(printed, printed.positions(model.neutral())[None])
    assert away == pytest.approx(0.0, abs=1e-4)
    np.testing.assert_allclose(local[0], printed.local_m, atol=1e-3)


@pytest.mark.parametrize(
    ("before", "after", "verdict"),
    [(12.0, 5.0, "holds"), (30.0, 5.0, "partly"), (12.0, 9.0, "does not hold")],
)
def test_the_verdict_is_on_both_numbers(monkeypatch, before, after, verdict):
    monkeypatch.setattr(placement, "measure_placement", lambda number: Placement(str(number), before, after))
    found = placement_findings(in_turn, quick=True)
    assert found.claims[0].verdict == verdict
    assert len(found.sheets[0].rows) == 1
    assert len(placement_findings(in_turn, quick=False).sheets[0].rows) == 8
