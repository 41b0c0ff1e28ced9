"""`mbkf report` writes one page; bad input is one line."""

import json

import pytest

from mbkf.cli.main import main
from mbkf.io.results_folder import write_reconstruction
from mbkf.pipelines.results.summary import summarise
from tests.recordings import walk


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    return write_reconstruction(walk(), summarise(walk()), tmp_path_factory.mktemp("walk") / "result")


def test_a_page_is_written_into_the_folder_or_elsewhere(result, tmp_path, capsys):
    assert main(["report", str(result)]) == 0
    assert capsys.readouterr().out.strip() == str(result / "report.html")
    assert main(["report", str(result), "--out", str(tmp_path / "r.html")]) == 0
    assert (tmp_path / "r.html").read_text() == (result / "report.html").read_text()


def test_labels_may_be_named(result, tmp_path):
    labels = tmp_path / "labels.json"
    labels.write_text(json.dumps({"ghosts_dropped": 4321, "assigned_fraction": 1.0}))
    assert main(["report", str(result), "--labels", str(labels), "--out", str(tmp_path / "r.html")]) == 0
    assert "4321 ghost points" in (tmp_path / "r.html").read_text()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["{none}"], "make it with 'mbkf reconstruct'"),
        (["{result}", "--labels", "{none}"], "make it with 'mbkf label'"),
        (["{result}", "--out", "{result}"], "is a folder"),
    ],
)
def test_bad_input_is_one_line(words, message, result, tmp_path, refused):
    places = {"none": tmp_path / "none", "result": result}
    refused(["report", *(word.format(**places) for word in words)], message)
