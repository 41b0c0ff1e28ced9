"""Options that several commands share are declared once, and numbers that cannot be are refused by name."""

import argparse

import pytest

from mbkf.cli.options import (
    add_axes_options,
    add_lag_option,
    add_spreads_option,
    asked_spreads,
    axes_options,
    check_positive,
    check_share,
    lag_seconds,
)
from mbkf.errors import InvalidInput


def test_axes_and_unit_are_left_open():
    parser = argparse.ArgumentParser()
    add_axes_options(parser)
    assert vars(parser.parse_args([])) == {"up": None, "axes": None, "unit": None}
    given = parser.parse_args(["--up=-y", "--unit", "mm", "--axes", "x,-z,y"])
    assert axes_options(given) == vars(given) == {"up": "-y", "axes": "x,-z,y", "unit": "mm"}


def test_a_lag_is_given_in_milliseconds():
    parser = argparse.ArgumentParser()
    add_lag_option(parser)
    assert lag_seconds(parser.parse_args([])) == 0.0
    assert lag_seconds(parser.parse_args(["--lag", "60"])) == pytest.approx(0.06)
    with pytest.raises(InvalidInput, match="--lag"):
        lag_seconds(parser.parse_args(["--lag=-5"]))


@pytest.mark.parametrize(
    "given, asked",
    [
        ([], ("torques", "angles")),
        (["--spreads", "all"], ("torques", "angles")),
        (["--spreads", "none"], ()),
        (["--spreads", "angles"], ("angles",)),
        (["--spreads", "angles,torques"], ("angles", "torques")),
    ],
)
def test_spreads_are_all_told_unless_some_are_named(given, asked):
    parser = argparse.ArgumentParser()
    add_spreads_option(parser)
    assert asked_spreads(parser.parse_args(given)) == asked


@pytest.mark.parametrize("value", [-1.0, float("nan"), float("inf"), 0.0])
def test_what_is_not_positive_is_refused(value):
    with pytest.raises(InvalidInput, match="--speed"):
        check_positive("--speed", value)


def test_zero_may_be_allowed():
    check_positive("--speed", 0.0, or_zero=True)
    check_positive("--speed", 0.1)


@pytest.mark.parametrize("value", [-0.1, 1.1, float("nan")])
def test_what_is_no_share_is_refused(value):
    with pytest.raises(InvalidInput, match="--loss"):
        check_share("--loss", value)


def test_shares_are_taken():
    check_share("--loss", 0.0)
    check_share("--loss", 1.0)
