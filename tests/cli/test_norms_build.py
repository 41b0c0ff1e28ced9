"""`mbkf norms build` writes bands; bad input is one line."""

import pytest

from mbkf.cli.main import main
from mbkf.io.norms import read_norms
from mbkf.io.results_folder import write_reconstruction
from mbkf.trial.results.summary import summarise
from tests.study.session.sessions import walks


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results")
    for person, first in (("P1", 5), ("P2", 6)):
        for r in walks(1, first):
            write_reconstruction(r, summarise(r), folder / person / "walk")
    return folder


def test_bands_are_written(results, tmp_path, capsys):
    out = tmp_path / "adults.toml"
    assert main(["norms", "build", str(results), "--out", str(out)]) == 0
    assert "of 2 persons" in capsys.readouterr().out and read_norms(out).name == "adults"
    assert main(["norms", "build", str(results), "--out", str(out), "--name", "Ours"]) == 0
    assert read_norms(out).name == "Ours"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["build", "{none}", "--out", "n.toml"], "no results are here"),
        (["build", "{one}", "--out", "n.toml"], "2 persons or more"),
        (["build", "{one}"], "--out"),
        ([], "COMMAND"),
    ],
)
def test_bad_input_is_one_line(words, message, results, tmp_path, refused):
    places = {"none": tmp_path / "none", "one": results / "P1"}
    refused(["norms", *(word.format(**places) for word in words)], message)
