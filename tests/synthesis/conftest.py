"""Motions and a capture that several tests share; none of them changes these."""

import pytest

from mbkf.synthesis.capture import CaptureSettings, synthesise_capture
from mbkf.synthesis.motions import motion_names
from mbkf.synthesis.person import body_of, synthesise_subject
from tests.recordings import performer

SECONDS = {
    "squat": 3.0,
    "walk": 2.5,
    "jump": 2.5,
    "turn": 3.8,
    "one_foot": 4.5,
    "reach": 3.5,
    "step_up": 3.2,
    "general": 10.0,
    "sit_to_stand": 5.6,
    "rail": 3.2,
    "kneel": 6.8,
    "belt_walk": 2.5,
    "split_belt_walk": 2.5,
    "star_arc": 5.8,
}


class Made(dict):
    """Motions by name, each made when it is first asked for."""

    def __missing__(self, name):
        return performer(name, SECONDS[name], 5)[2]


@pytest.fixture(scope="session")
def person():
    return synthesise_subject(5)


@pytest.fixture(scope="session")
def body(person):
    return body_of(person)


@pytest.fixture(scope="session")
def motions():
    return Made()


@pytest.fixture(scope="session", params=motion_names())
def motion(request, motions):
    return motions[request.param]


@pytest.fixture(scope="session")
def capture(person, motions):
    return synthesise_capture(person, motions["jump"], CaptureSettings(occlusion=0.05), seed=5)
