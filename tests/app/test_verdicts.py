"""Verdicts for the page: words of results, the gravest of a session, nothing without a result."""

from mbkf.app.verdicts import gravest_on, verdict_on
from mbkf.io.results_folder import write_reconstruction
from mbkf.io.verdict import Reason, Verdict
from mbkf.trial.results.summary import summarise
from tests.io.reconstructions import made_up

LOOK = Verdict.of([Reason("trunk", "look", "markers 20 mm off", "not posed as they are", "check names")])


def written(folder, verdict):
    r = made_up(verdict=verdict)
    write_reconstruction(r, summarise(r), folder)
    return folder


def test_a_result_s_verdict_has_word_line_and_reasons(tmp_path):
    assert verdict_on(written(tmp_path / "a", LOOK)) == {
        "word": "look", "line": LOOK.line, "reasons": list(LOOK.sentences),
    }  # fmt: skip


def test_a_session_has_the_gravest_word_of_its_results(tmp_path):
    right, odd = written(tmp_path / "a", Verdict()), written(tmp_path / "b", LOOK)
    assert gravest_on([right]) == "use" and gravest_on([right, odd]) == "look"


def test_a_session_with_a_failed_trial_calls_for_a_look(tmp_path):
    right = written(tmp_path / "a", Verdict())
    assert gravest_on([right], incomplete=True) == "look"
    assert gravest_on([], incomplete=True) is None


def test_folders_without_a_verdict_say_nothing(tmp_path):
    assert verdict_on(tmp_path) is None
    assert verdict_on(written(tmp_path / "old", None)) is None
    assert gravest_on([tmp_path, tmp_path / "old"]) is None


def test_a_new_result_in_the_same_folder_is_read_anew(tmp_path):
    written(tmp_path / "a", Verdict())
    assert gravest_on([tmp_path / "a"]) == "use"
    written(tmp_path / "a", LOOK)
    assert gravest_on([tmp_path / "a"]) == "look"
