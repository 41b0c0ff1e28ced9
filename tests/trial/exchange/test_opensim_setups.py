"""Set-ups of OpenSim's tools: actuators, analyses with and without controls, and spans that are too short."""

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.storage import Table
from mbkf.trial.exchange.opensim_setups import actuators, analysis, common_span, document, inverse_dynamics


def table(times_s, *names):
    return Table(names, np.array(times_s), np.zeros((len(times_s), len(names))))


def test_the_span_is_that_of_both_tables():
    motion = table([0.0, 0.1, 0.2, 0.3, 0.4], "tilt")
    assert common_span(motion, table([0.1, 0.25], "force")) == (0.1, 0.2)
    for loads in (table([0.1, 0.15], "force"), table([0.0, 0.4])):
        with pytest.raises(InvalidInput, match="two frames with both"):
            common_span(motion, loads)


def test_actuators_act_on_their_coordinates_without_limits():
    one, other = actuators({"a": ("knee", 1.0), "b": ("tilt", 100.0)}).iter("CoordinateActuator")
    assert (one.get("name"), one.findtext("coordinate"), one.findtext("optimal_force")) == ("a", "knee", "1")
    assert (other.findtext("optimal_force"), other.findtext("min_control")) == ("100", "-inf")


def test_an_analysis_has_its_settings_and_controls_where_asked():
    plain = analysis((0.0, 1.5), "out", {"StaticOptimization": {"use_model_force_set": "true"}})
    (kind,) = plain.find("AnalysisSet/objects")
    assert (kind.tag, kind.findtext("on"), kind.findtext("use_model_force_set")) == (
        "StaticOptimization",
        "true",
        "true",
    )
    assert plain.findtext("final_time") == "1.5" and plain.find("ControllerSet") is None
    driven = analysis((0.0, 1.0), "out", {}, "controls.sto")
    assert driven.findtext(".//ControlSetController/controls_file") == "controls.sto"


def test_documents_are_marked_as_ours():
    lines = document(inverse_dynamics((0.0, 1.0))).splitlines()
    assert lines[0].startswith("<?xml") and "written by mbkf" in lines[1]
    assert "<time_range>0.0 1.0</time_range>" in "".join(lines)
