"""`mbkf norms build` writes bands; bad input is one line."""

import pytest

from mbkf.cli.main import main
from mbkf.io.norms import read_norms
from mbkf.io.results_folder import write_reconstruction
from mbkf.io.session import SESSION_FILE, SessionNotes, write_session
from mbkf.trial.results.summary import summarise
from tests.study.session.sessions import walks


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results")
    for person, first in (("P1", 5), ("P2", 6)):
        for r in walks(1, first):
            write_reconstruction(r, summarise(r), folder / person / "walk")
        write_session(SessionNotes(sex="female", age=30.0 + first), folder / person / SESSION_FILE)
    (folder / "P2" / SESSION_FILE).rename(folder / "P2" / "unread.toml")
    for r in walks(1, 6):
        write_reconstruction(r, summarise(r), folder / "P3" / "walk")
    write_session(SessionNotes(sex="male", age=41.0), folder / "P3" / SESSION_FILE)
    return folder


def test_bands_are_written(results, tmp_path, capsys):
    out = tmp_path / "adults.toml"
    assert main(["norms", "build", str(results), "--out", str(out)]) == 0
    printed = capsys.readouterr().out
    assert (
        "P1: female, 35 years, " in printed and "P3: male, 41 years, " in printed and "2 persons, " in printed
    )
    assert "left out: P2: age and sex not stated" in printed and "of 2 persons" in printed
    assert [one.name for one in read_norms(out).persons] == ["P1", "P3"] and read_norms(out).name == "adults"
    assert main(["norms", "build", str(results), "--out", str(out), "--name", "Ours"]) == 0
    assert read_norms(out).name == "Ours"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["build", "{none}", "--out", "n.toml"], "no results are here"),
        (["build", "{one}", "--out", "n.toml"], "2 persons or more"),
        (
            ["build", "{all}", "--without", "P1", "--out", "n.toml"],
            "here 1. Left out: P1: the person in view",
        ),
        (["build", "{all}", "--without", "P9", "--out", "n.toml"], "P9"),
        (["build", "{one}"], "--out"),
        ([], "COMMAND"),
    ],
)
def test_bad_input_is_one_line(words, message, results, tmp_path, refused):
    places = {"none": tmp_path / "none", "one": results / "P1", "all": results}
    refused(["norms", *(word.format(**places) for word in words)], message)
