"""Files of declared quantities: labelled axes, units, meanings and codes that any HDF5 library and xarray read."""

import warnings
from dataclasses import replace

import h5py
import numpy as np
import pytest

from mbkf.io.body_covariance import BodyCovariance
from mbkf.io.dimensions import AXES
from mbkf.io.results import QUANTITIES
from mbkf.io.results_h5 import write_h5
from tests.io.reconstructions import COORDINATES, made_up, made_up_whole


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    known = BodyCovariance(("head",), ("A", "B"), np.tril(np.random.default_rng(2).normal(size=(7, 7))))
    path = tmp_path_factory.mktemp("result") / "motion.h5"
    write_h5(made_up_whole(subject=replace(made_up().subject, covariance=known)), path)
    return path


def test_every_axis_of_every_dataset_has_one_scale_with_its_labels(path):
    with h5py.File(path) as file:
        for key, dataset in file.items():
            if dataset.is_scale:
                continue
            assert [len(dimension) for dimension in dataset.dims] == [1] * dataset.ndim, key
            for dimension, size in zip(dataset.dims, dataset.shape, strict=True):
                assert dimension[0].shape == (size,)
        for name, one in QUANTITIES.items():
            if one.key in file and not file[one.key].is_scale:
                scales = [dimension[0].name for dimension in file[one.key].dims]
                assert scales == [f"/{AXES[axis].names}" for axis in one.axes], name
        assert list(file["foot"].asstr()) == ["right", "left"]
        assert list(file["wrench"].asstr())[::5] == ["force_x", "moment_z"]
        assert list(file["coordinate_names"].asstr()) == list(COORDINATES)


def test_every_dataset_states_its_meaning_and_codes(path):
    with h5py.File(path) as file:
        for dataset in file.values():
            assert dataset.attrs["long_name"]
            assert dataset.is_scale or dataset.attrs["axes"]
        assert file["foot_cop_m"].attrs["axes"] == "times_s; foot: right, left; xyz: x, y, z"
        assert file["angles"].attrs["axes"] == "times_s; coordinate_names"
        assert "x forward, y left, z up" in file["xyz"].attrs["long_name"]
        footing = file["footing"].attrs
        assert footing["flag_values"].tolist() == [-1, 0, 1, 2]
        assert footing["flag_meanings"].split() == ["unmeasured", "air", "own_plate", "shared_plate"]
        assert file["foot_wrench"].attrs["component_units"] == "N, N, N, N m, N m, N m"
        assert file["angles"].attrs["component_units"] == "rad, m, rad"
        assert "component_units" not in file["foot_cop_m"].attrs
        assert file["sd_q"].attrs["ancillary_variables"] == "sd_q_offset"
        assert file["angles"].attrs["ancillary_variables"] == "angles_sd"


@pytest.mark.parametrize("frames", [0, 12])
def test_xarray_shows_axes_and_labels(path, tmp_path, frames):
    import xarray

    if not frames:
        path = tmp_path / "empty.h5"
        write_h5(made_up(0), path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        data = xarray.open_dataset(path, engine="h5netcdf")
    r = made_up_whole() if frames else made_up(0)
    with data:
        assert data["angles"].dims == ("times_s", "coordinate_names")
        np.testing.assert_array_equal(
            data["angles"].sel(coordinate_names="hip_flexion_r"), r.angle("hip_flexion_r")
        )
        up = data["foot_wrench"].sel(foot="left", wrench="force_z")
        np.testing.assert_array_equal(up, r.foot_wrench[:, 1, 2])
        assert data["singular"].dtype == bool
        assert data["times_s"].attrs["units"] == "s"
        for name, one in data.data_vars.items():
            assert not any(str(dimension).startswith("phony") for dimension in one.dims), name


def test_labels_take_little_room(tmp_path):
    """At most 1.2 kB for each dataset besides its numbers; a trial of 5 s has 1 to 5 MB."""
    write_h5(made_up_whole(), tmp_path / "motion.h5")
    with h5py.File(tmp_path / "motion.h5") as file:
        stored = sum(dataset.id.get_storage_size() for dataset in file.values())
        count = len(file)
    assert (tmp_path / "motion.h5").stat().st_size - stored < 1200 * count
