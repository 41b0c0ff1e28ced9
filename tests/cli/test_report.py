"""`mbkf report` writes one page; bad input is one line."""

import json

import pytest

from mbkf.cli.main import main
from mbkf.io.results_folder import write_reconstruction
from mbkf.trial.results.summary import summarise
from tests.recordings import walk
from tests.study.session.sessions import walks


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
    assert "4321 reflections" in (tmp_path / "r.html").read_text()


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


@pytest.fixture(scope="module")
def sessions(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sessions")
    for name, count in (("before", 1), ("after", 2)):
        for k, r in enumerate(walks(count)):
            write_reconstruction(r, summarise(r), folder / name / f"walk{k}")
    return folder


def test_a_session_is_one_page(sessions, tmp_path, capsys):
    after, before, curves = sessions / "after", sessions / "before", tmp_path / "c.parquet"
    assert main(["report", str(after)]) == 0
    assert capsys.readouterr().out.strip() == str(after / "report.html")
    page = (after / "report.html").read_text()
    assert 'id="gait-walk"' in page and 'id="change"' not in page
    words = ["--against", str(before), "--language", "es", "--curves", str(curves), "--name", "Ana"]
    assert main(["report", str(after), *words, "--out", str(tmp_path / "r.html")]) == 0
    page = (tmp_path / "r.html").read_text()
    assert 'id="change"' in page and ">Ana</h1>" in page and "Antes" in page and curves.is_file()
    single = str(after / "walk0")
    assert main(["report", single, "--name", "Ana", "--out", str(tmp_path / "s.html")]) == 0
    assert 'id="gait-walk"' in (tmp_path / "s.html").read_text()
    assert main(["report", single, "--language", "es", "--out", str(tmp_path / "t.html")]) == 0
    assert "Fotogramas seguidos" in (tmp_path / "t.html").read_text()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["{after}", "--labels", "x.json"], "report of one trial"),
        (["{after}", "--norms", "{none}"], "none"),
        (["{after}", "--language", "xx"], "choose en, es"),
        (["{after}", "--curves", "c.xlsx"], "written as .csv or .parquet"),
        (["{empty}"], "no results are here"),
        (["{after}", "--against", "{empty}"], "no results are here"),
    ],
)
def test_bad_input_of_a_session_is_one_line(words, message, sessions, tmp_path, refused):
    places = {"after": sessions / "after", "none": tmp_path / "none", "empty": tmp_path}
    refused(["report", *(word.format(**places) for word in words)], message)


def test_external_moments_belong_to_the_clinical_convention(result, capsys, refused):
    assert main(["report", str(result), "--moments", "external"]) == 0
    assert "convention: clinical, to which external moments belong" in capsys.readouterr().out
    words = ["report", str(result), "--moments", "external", "--convention", "isb"]
    refused(words, "not to isb; give --convention clinical")
