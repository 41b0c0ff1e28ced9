"""Files of norms: what is written comes back, and what is damaged is refused."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.errors import FileFormatError
from mbkf.io.norms import POINTS, Band, Norms, read_norms, write_norms

NUMBER = st.floats(-1e5, 1e5)


def norms(name="ours", mean=0.5, sd=0.25):
    curve = Band("deg", 3, np.full(POINTS, mean), np.full(POINTS, sd))
    return Norms(
        name,
        {("walk", "angle", "knee_angle"): curve},
        {("walk", "Speed"): Band("m/s", 3, np.array([1.25]), np.array([0.1]))},
    )


@given(st.text(max_size=20), NUMBER, st.floats(0.0, 1e5))
def test_what_is_written_comes_back(tmp_path_factory, name, mean, sd):
    file = tmp_path_factory.mktemp("norms") / "n.toml"
    made = norms(name, mean, sd)
    write_norms(made, file)
    found = read_norms(file)
    assert found.name == name and found.curves.keys() == made.curves.keys()
    for one, other in zip(
        [*found.curves.values(), *found.measures.values()],
        [*made.curves.values(), *made.measures.values()],
        strict=True,
    ):
        assert (one.unit, one.persons) == (other.unit, other.persons)
        np.testing.assert_allclose(one.mean, other.mean, rtol=1e-5)
        np.testing.assert_allclose(one.sd, other.sd, rtol=1e-5)


@pytest.mark.parametrize(
    ("old", "new", "fragment"),
    [
        ('format = "mbkf norms"', 'format = "x"', "mbkf norms build"),
        ("format_version = 1", "format_version = 2", "mbkf norms build"),
        ('name = "ours"', "name = 3", "name must be a text"),
        ("persons = 3", "persons = 0", "persons must be"),
        ("persons = 3", "persons = true", "persons must be"),
        ('unit = "m/s"', "unit = 1", "unit must be a text"),
        ("mean = [1.25]", "mean = [1.25, 2.0]", "mean must be 1 numbers"),
        ("mean = [1.25]", "mean = [nan]", "mean must be 1 numbers"),
        ("mean = [1.25]", 'mean = ["a"]', "mean must be 1 numbers"),
        ("sd = [0.1]", "sd = [-0.1]", "sd must not be negative"),
        ("[[measure]]", "[measure]", "must be a list of tables"),
    ],
)
def test_damaged_files_are_refused(tmp_path, old, new, fragment):
    file = tmp_path / "n.toml"
    write_norms(norms(), file)
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1))
    with pytest.raises(FileFormatError, match=fragment):
        read_norms(file)


def test_no_file():
    with pytest.raises(FileFormatError):
        read_norms("nothing.toml")


@pytest.mark.parametrize("speeds", [(1.4, 1.0), (1.0, 1.0)])
def test_a_range_of_speeds_begins_with_the_lower_one(tmp_path, speeds):
    one = norms()
    file = tmp_path / "norms.toml"
    write_norms(replace(one, by_speed={(1.0, 1.4): one.curves}), file)
    assert list(read_norms(file).by_speed) == [(1.0, 1.4)]
    write_norms(replace(one, by_speed={speeds: one.curves}), file)
    with pytest.raises(FileFormatError, match="needs the lower speed first"):
        read_norms(file)
