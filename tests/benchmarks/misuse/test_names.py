"""Commands run in folders of special names, and codes for terminals in their words are noticed."""

import os

import pytest

from benchmarks.misuse.calls import commands
from benchmarks.misuse.cases import Case
from benchmarks.misuse.names import NAMES, PLACES, named
from benchmarks.misuse.world import INPUTS
from mbkf.conventions import data_folder

CHECKED = Case("protocol show", "{protocol} --no-browser --out {OUT}", "new.html")


@pytest.fixture(scope="module")
def world(tmp_path_factory):
    folder = tmp_path_factory.mktemp("world")
    (folder / INPUTS["protocol"]).write_bytes((data_folder("markers") / "reference36.toml").read_bytes())
    return folder


@pytest.mark.parametrize("place", ["UTF-8", "LC_ALL=C, no UTF-8 mode"])
def test_a_command_works_in_every_name_and_place(tmp_path, world, place):
    environment = {**os.environ, **PLACES[place]}
    with commands(tmp_path / "servers", 1, environment=environment) as run:
        for number, name in enumerate(("plain", "no UTF-8", "emoji", "a line end", "markup")):
            assert named(run, CHECKED, name, world, tmp_path / f"{number}") == "", name
    assert set(NAMES) >= {"a leading dash", "right to left"}
