"""The registry of motions: built-in ones, one of the user's own, and no heavy import."""

import subprocess
import sys

import numpy as np
import pytest

from mbkf.cli.main import build_parser
from mbkf.errors import InvalidInput, UnknownName
from mbkf.synthesis import motions
from mbkf.synthesis.motions import motion_names, register_motion, registered_motion
from mbkf.synthesis.squat import squat_plan
from mbkf.trial.synth import synthesise


@pytest.fixture
def registry(monkeypatch):
    """A registry that forgets what a test adds."""
    monkeypatch.setattr(motions, "_MOTIONS", dict(motions._MOTIONS))


def test_built_in_motions_are_named_and_those_of_static_captures_only_on_request():
    feet = ("squat", "walk", "jump", "turn", "one_foot", "reach", "step_up", "general")
    trials = (*feet, "sit_to_stand", "rail", "kneel", "belt_walk", "split_belt_walk", "star_arc")
    assert motion_names() == trials
    assert motion_names(static=True) == (*trials, "stand")


@pytest.mark.parametrize("name", motion_names(static=True))
def test_every_registered_motion_has_its_plan(name, body):
    motion = registered_motion(name)
    plan = motion.planner(body, motion.seconds, np.random.default_rng(0))
    assert plan.end_s - plan.start_s >= motion.seconds


def test_random_streams_differ():
    streams = [registered_motion(name).stream for name in motion_names(static=True)]
    assert len(set(streams)) == len(streams)


@pytest.mark.usefixtures("registry")
def test_a_motion_of_ones_own_is_made_and_offered():
    @register_motion("deep squat", seconds=1.2)
    def deep_squat_plan(model, seconds, rng):
        return squat_plan(model, seconds, rng)

    assert motion_names()[-1] == "deep squat"
    assert build_parser().parse_args(["demo", "--motion", "deep squat"]).motion == "deep squat"
    _, capture = synthesise("deep squat", seed=2)
    assert capture.trial.markers.times_s[-1] == pytest.approx(1.2)
    assert deep_squat_plan is registered_motion("deep squat").planner


@pytest.mark.usefixtures("registry")
@pytest.mark.parametrize("name", ["", "walk"])
def test_a_name_that_is_empty_or_taken_is_refused(name):
    with pytest.raises(InvalidInput, match="empty or taken"):
        register_motion(name, seconds=1.0)(squat_plan)


def test_an_unknown_motion_is_answered_with_the_known_ones():
    with pytest.raises(UnknownName, match="walk"):
        registered_motion("wlak")


def test_names_come_without_heavy_libraries():
    code = "import sys, mbkf.synthesis.motions; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert not {"scipy", "pinocchio", "casadi", "matplotlib"} & set(loaded.split())
