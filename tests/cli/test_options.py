"""Options that several commands share are declared once, and impossible values are refused by the option's name."""

import argparse

import pytest

from mbkf.cli.options import (
    add_axes_options,
    add_lag_option,
    add_page_options,
    add_spreads_option,
    asked_spreads,
    axes_options,
    body_mass,
    comma_separated,
    count,
    lag_seconds,
    natural,
    not_negative,
    port,
    positive,
    share,
    time_window,
)
from mbkf.errors import InvalidInput


def test_axes_and_unit_are_left_open():
    parser = argparse.ArgumentParser()
    add_axes_options(parser)
    assert vars(parser.parse_args([])) == {"up": None, "axes": None, "unit": None, "person": None}
    given = parser.parse_args(["--up=-y", "--unit", "mm", "--axes", "x,-z,y", "--person", "Anna"])
    assert axes_options(given) == vars(given) == {
        "up": "-y", "axes": "x,-z,y", "unit": "mm", "person": "Anna",
    }  # fmt: skip


def test_a_lag_is_given_in_milliseconds(capsys):
    parser = argparse.ArgumentParser()
    add_lag_option(parser)
    assert lag_seconds(parser.parse_args([])) == 0.0
    assert lag_seconds(parser.parse_args(["--lag", "60"])) == pytest.approx(0.06)
    with pytest.raises(SystemExit):
        parser.parse_args(["--lag=-5"])
    assert "--lag" in capsys.readouterr().err


def test_a_page_has_any_free_port_unless_one_is_named():
    parser = argparse.ArgumentParser()
    add_page_options(parser)
    assert vars(parser.parse_args([])) == {"port": 0, "no_browser": False}
    assert parser.parse_args(["--port", "8123"]).port == 8123


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
def test_spreads_are_all_stated_unless_some_are_named(given, asked):
    parser = argparse.ArgumentParser()
    add_spreads_option(parser)
    assert asked_spreads(parser.parse_args(given)) == asked


@pytest.mark.parametrize(
    ("kind", "taken", "refused"),
    [
        (body_mass, {"71.5": 71.5}, ("0", "-70")),
        (positive, {"0.1": 0.1, "2": 2.0}, ("0", "-1")),
        (not_negative, {"0": 0.0, "0.1": 0.1}, ("-1", "-1e-9")),
        (share, {"0": 0.0, "0.5": 0.5, "1": 1.0}, ("-0.1", "1.1")),
        (natural, {"0": 0, "7": 7}, ("-1", "1.5")),
        (count, {"1": 1, "7": 7}, ("0", "1.5")),
        (port, {"0": 0, "65535": 65535}, ("-1", "65536", "80.5")),
    ],
)
def test_numbers_are_taken_where_they_are_possible(kind, taken, refused):
    for text, value in taken.items():
        assert kind(text) == value and type(kind(text)) is type(value)
    for text in (*refused, "nan", "inf", "many", ""):
        with pytest.raises(argparse.ArgumentTypeError, match=f"'{text}' is not a"):
            kind(text)


def test_words_stand_between_commas():
    assert comma_separated(" a, b,,c ") == ("a", "b", "c")
    assert comma_separated("") == ()


def test_a_time_window_has_two_times_in_order():
    assert time_window("--standing", "0:1.5") == (0.0, 1.5)
    for text in ("3", "1:1", "2:1", "a:b", "nan:1", ":"):
        with pytest.raises(InvalidInput, match=f"--standing '{text}': write START:END"):
            time_window("--standing", text)
