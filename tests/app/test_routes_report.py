"""The report's page and files over the page's server."""

import io

import pyarrow.parquet as pq
import pytest

from mbkf.io.results_folder import write_reconstruction
from mbkf.trial.results.summary import summarise
from tests.app.asking import asked, plain
from tests.app.test_norm_files import table
from tests.study.session.sessions import walks


@pytest.fixture(scope="module")
def done(server):
    r = walks()[0]
    write_reconstruction(r, summarise(r), server.workspace.out / "P1" / "walk1")
    return server


def test_a_report_and_its_curves(done, cookie):
    answer, text = asked(done, "/report?session=P1&language=es", Cookie=cookie)
    assert answer.status == 200 and b'id="gait-walk"' in text and b'lang="es"' in text
    for kind in ("csv", "parquet"):
        answer, content = asked(done, f"/report/curves?session=P1&as={kind}", Cookie=cookie)
        assert (
            answer.status == 200
            and f"filename*=utf-8''curves.{kind}" in answer.headers["Content-Disposition"]
        )
    assert pq.read_table(io.BytesIO(content)).num_rows > 1000


def test_what_is_missing_is_told(done, cookie):
    status, found = plain(done, cookie, "/report/choices?session=P1")
    assert status == 200 and found["sessions"] == found["norms"] == []
    assert all(found["charts"][name] in offered for name, offered in found["chart_choices"].items())
    assert asked(done, "/report?session=P9", Cookie=cookie)[0].status == 404
    assert asked(done, "/report?session=P1&language=xx", Cookie=cookie)[0].status == 404
    assert plain(done, cookie, "/report/curves?session=P9")[0] == 400
    status, said = plain(done, cookie, "/norms", "POST")
    assert status == 400 and "2 persons or more" in said["trouble"]


def test_a_missing_fact_of_foreign_norms_is_named(done, cookie):
    status, found = plain(done, cookie, "/norms/import?file=a.csv&source=Rossi&do=write", "POST", table())
    assert status == 200 and found["missing"] == ["convention", "persons", "ages", "speeds"]
    assert found["facts"]["source"] == "Rossi"
