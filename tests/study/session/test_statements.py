"""The session file of results: beside them, or beside the captures, with the person's own above it."""

import json

from mbkf.io.session import SessionNotes
from mbkf.study.batch.inputs import RECORD
from mbkf.study.session.statements import session_files, stated_on_results


def test_the_nearest_file_counts_with_the_persons_own(tmp_path):
    captures, place = tmp_path / "study" / "P1" / "monday", tmp_path / "results" / "P1"
    result = place / "walk"
    for folder in (captures, result):
        folder.mkdir(parents=True)
    assert stated_on_results(place, result) == SessionNotes(), "a result without a record"
    (result / RECORD).write_text(json.dumps({"files": {str(captures / "walk.c3d"): "0"}}))
    assert session_files(place, result) == []
    (captures / "session.toml").write_text('[visit]\ndate = 2025-03-31\n[trial.walk]\ncondition = "shoes"\n')
    (captures.parent / "session.toml").write_text('[visit]\ndiagnosis = "D"\n[trial.walk]\nkind = "run"\n')
    found = stated_on_results(place, result)
    assert (found.visit.date, found.visit.diagnosis, found.condition("walk")) == ("2025-03-31", "D", "shoes")
    assert found.trial("walk").kind is None
    (place / "session.toml").write_text("[visit]\ndate = 2025-04-01\n")
    assert stated_on_results(place, result).visit.date == "2025-04-01"
