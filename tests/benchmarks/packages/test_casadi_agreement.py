"""The comparison of CasADi with Pinocchio sees a difference in each output, and NaN."""

import dataclasses

import casadi as ca
import numpy as np
import pytest

import mbkf
from benchmarks.packages import casadi_agreement
from benchmarks.packages.casadi_agreement import agreement
from mbkf.model.casadi_dynamics import CasadiDynamics
from mbkf.synthesis.person import synthesise_subject

PERSON = synthesise_subject(2)
FUNCTIONS = tuple(one.name for one in dataclasses.fields(CasadiDynamics) if one.type == "ca.Function")


@pytest.fixture(scope="module")
def exact():
    return mbkf.casadi_dynamics(PERSON)


def spoilt(function, factor):
    symbols = [ca.SX.sym(name, *function.size_in(k)) for k, name in enumerate(function.name_in())]
    outputs = [factor * value for value in function.call(symbols)]
    return ca.Function(function.name(), symbols, outputs)


def test_all_functions_are_compared():
    found = agreement(PERSON, 2, np.random.default_rng(4))
    assert len(found) == len(FUNCTIONS) + 3, "three groups of points have positions and velocities"
    assert max(found.values()) < 1e-12


@pytest.mark.parametrize("factor", [1.0 + 1e-8, np.nan])
@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_difference_is_seen(exact, name, factor, monkeypatch):
    other = dataclasses.replace(exact, **{name: spoilt(getattr(exact, name), factor)})
    monkeypatch.setattr(mbkf, "casadi_dynamics", lambda subject: other, raising=False)
    found = casadi_agreement.agreement(PERSON, 2, np.random.default_rng(4))
    wrong = [part for part, value in found.items() if not value <= 1e-10]
    assert len(wrong) == (2 if name in {"markers", "segments", "soles"} else 1)
