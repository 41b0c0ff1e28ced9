"""The wide table of a result: a row a frame, names with units, numbers as the result holds them."""

import csv
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.errors import FileFormatError
from mbkf.io.contacts import Source
from mbkf.io.results_folder import read_blocks
from mbkf.io.written import TABLE, form_of
from mbkf.trial.exchange.result_csv import leaves, plain, write_csv, write_result_csv
from tests.recordings import broken_walk, leaning_walk, walk


def read(path):
    with path.open(newline="") as file:
        names, *rows = csv.reader(file)
    return {name: list(column) for name, column in zip(names, zip(*rows, strict=True), strict=True)}


def numbers(column):
    return np.array([float(one) if one else np.nan for one in column])


@cache
def result():
    """The leaning walk with rates and standard deviations of their own."""
    r, rng = leaning_walk(), np.random.default_rng(1)
    rates, sd = rng.normal(size=r.angle_rates.shape), rng.uniform(1.0, 2.0, r.moments.shape)
    return replace(
        r, angle_rates=rates, moments_sd=sd, foot_wrench_sd=rng.uniform(1.0, 2.0, r.foot_wrench.shape)
    )


@pytest.fixture(scope="module")
def columns(tmp_path_factory):
    path = tmp_path_factory.mktemp("csv") / "walk.csv"
    write_result_csv(result(), path)
    assert form_of(path) == TABLE
    return read(path)


def test_blocks_make_the_table_of_the_whole(tmp_path):
    r = result()
    write_result_csv(r, tmp_path / "whole.csv")
    write_csv((r.part(slice(begin, begin + 7)) for begin in range(0, r.frames, 7)), tmp_path / "blocks.csv")
    assert (tmp_path / "blocks.csv").read_bytes() == (tmp_path / "whole.csv").read_bytes()


def test_a_result_that_cannot_be_read_leaves_no_folder(tmp_path):
    with pytest.raises(FileFormatError):
        write_csv(read_blocks(tmp_path / "missing.h5"), tmp_path / "new" / "walk.csv")
    assert list(tmp_path.iterdir()) == []


def test_coordinates_are_in_degrees_and_metres_with_their_loads(columns):
    r = result()
    for name, unit, factor in (("knee_angle_r", "deg", 180 / np.pi), ("pelvis_tx", "m", 1.0)):
        load = ("force", "n") if unit == "m" else ("moment", "nm")
        for column, wanted in (
            (f"{name}_{unit}", factor * r.angle(name)),
            (f"{name}_sd_{unit}", factor * r.angle_sd(name)),
            (f"{name}_rate_{unit}_s", factor * r.angle_rate(name)),
            (f"{name}_{load[0]}_{load[1]}", r.moment(name)),
            (f"{name}_{load[0]}_sd_{load[1]}", r.moment_sd(name)),
        ):
            np.testing.assert_allclose(numbers(columns[column]), wanted, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(numbers(columns["knee_angle_r_power_w"]), r.power("knee_angle_r"), atol=1e-9)


def test_loads_stand_by_the_part_with_their_source_in_words(columns):
    r = result()
    for k, part in enumerate(r.loads.names):
        for axis in range(3):
            found = numbers(columns[f"{part}_force_{'xyz'[axis]}_n"])
            np.testing.assert_allclose(found, r.loads.wrench[:, k, axis], rtol=1e-9, atol=1e-9)
            found = numbers(columns[f"{part}_moment_{'xyz'[axis]}_nm"])
            np.testing.assert_allclose(found, r.loads.wrench[:, k, 3 + axis], rtol=1e-9, atol=1e-9)
            found = numbers(columns[f"{part}_force_sd_{'xyz'[axis]}_n"])
            np.testing.assert_allclose(found, r.loads.wrench_sd[:, k, axis], rtol=1e-9, atol=1e-9)
            found = numbers(columns[f"{part}_point_{'xyz'[axis]}_m"])
            np.testing.assert_allclose(found, r.loads.point_m[:, k, axis], rtol=1e-9, atol=1e-9)
        assert columns[f"{part}_source"] == [Source(one).name.lower() for one in r.loads.source[:, k]]
    assert set(columns["left_foot_source"]) == {"none", "measured", "estimated"}


def test_unknown_numbers_are_empty_and_names_are_plain(tmp_path):
    r = broken_walk()
    write_result_csv(r, tmp_path / "w.csv")
    found = read(tmp_path / "w.csv")
    first = plain(r.marker_names[0])
    np.testing.assert_allclose(numbers(found[f"{first}_y_m"]), r.measured_m[:, 0, 1], rtol=1e-9)
    assert found[f"{first}_x_m"][20:50] == [""] * 30
    assert found["tracked"] == [str(int(one)) for one in r.tracked]
    assert all(name == plain(name) for name in found)


def test_markers_that_would_be_called_alike_keep_a_column_each(tmp_path):
    r = walk()
    names = ("R-TOE", "R TOE", "R_TOE_model", *r.marker_names[3:])
    write_result_csv(replace(r, marker_names=names), tmp_path / "w.csv")
    found = read(tmp_path / "w.csv")
    for k, (measured, on_body) in enumerate(
        (("R_TOE", "R_TOE_model_2"), ("R_TOE_2", "R_TOE_2_model"), ("R_TOE_model", "R_TOE_model_model"))
    ):
        np.testing.assert_allclose(numbers(found[f"{measured}_x_m"]), r.measured_m[:, k, 0], rtol=1e-9)
        np.testing.assert_allclose(numbers(found[f"{on_body}_x_m"]), r.predicted_m[:, k, 0], rtol=1e-9)


DATA = st.recursive(
    st.none() | st.integers() | st.text(max_size=3),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(st.text("ab", min_size=1, max_size=2), inner, max_size=3)
    ),
    max_leaves=8,
)


@settings(max_examples=40)
@given(DATA)
def test_every_value_of_plain_data_is_found_once_under_its_path(data):
    def at(path):
        value = data
        for word in path.split(".") if path else ():
            value = value[word] if isinstance(value, dict) else value[int(word) - 1]
        return value

    def count(value):
        inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else None
        return 1 if inner is None else sum(map(count, inner))

    found = list(leaves(data))
    assert len(found) == count(data) == len(dict(found))
    assert all(at(path) == value for path, value in found)
