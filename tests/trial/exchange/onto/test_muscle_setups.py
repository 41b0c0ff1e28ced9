"""Set-ups of OpenSim for excitations of muscles."""

import pytest

from mbkf.trial.exchange.onto.muscle_setups import cmc_tasks, moco_inverse, muscle_control


def test_errors_of_coordinates_fade_without_swinging():
    tasks = list(cmc_tasks(("hip_flexion_r", "pelvis_tx")).iter("CMC_Joint"))
    assert [one.findtext("coordinate") for one in tasks] == ["hip_flexion_r", "pelvis_tx"]
    for one in tasks:
        kp, kv = (float(one.findtext(tag).split()[0]) for tag in ("kp", "kv"))
        # ë + kv ė + kp e = 0 has one double root.
        assert kp > 0.0 and kv**2 == pytest.approx(4.0 * kp)
        assert one.findtext("on") == "true" and one.findtext("active").split()[0] == "true"


def test_both_cover_the_span():
    for tool in (muscle_control((0.25, 1.5)), moco_inverse((0.25, 1.5), 1.0, 100.0)):
        assert (float(tool.findtext("initial_time")), float(tool.findtext("final_time"))) == (0.25, 1.5)


def test_moco_has_the_reserves_of_static_optimisation_and_residuals_at_the_root_first():
    steps = list(moco_inverse((0.0, 1.0), 2.0, 50.0).find("ModelProcessor/operators"))
    residuals, reserves = (
        next(one for one in steps if one.tag == f"ModOpAdd{kind}") for kind in ("Residuals", "Reserves")
    )
    # Each step leaves coordinates alone that have an actuator.
    assert steps.index(residuals) < steps.index(reserves)
    assert reserves.findtext("optimal_force") == "2"
    assert {one.text for one in residuals} == {"50"}
