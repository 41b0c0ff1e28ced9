"""A Dask cluster of this computer does what local processes do."""

import os
from importlib.util import find_spec

import pytest

from mbkf.errors import InvalidInput
from mbkf.study.batch import cluster
from mbkf.study.batch.cluster import LOCAL, ClusterWorkers
from mbkf.study.batch.outcome import Status
from mbkf.study.batch.worker_process import KILLED
from tests.batch_tasks import Answer, Die, Fail

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("default"),
    pytest.mark.skipif(find_spec("distributed") is None, reason="Dask is not installed"),
]


@pytest.fixture(scope="module")
def workers():
    made = ClusterWorkers(LOCAL, 2)
    yield made
    made.close()


def test_every_task_is_answered_once_and_told_by_its_place(workers, tmp_path):
    found = dict(workers.run(Answer(k, tmp_path) for k in range(25)))
    assert {number: outcome.reason for number, outcome in found.items()} == {k: str(k) for k in range(25)}
    assert len(list(tmp_path.iterdir())) == 25


def test_an_error_becomes_a_reason(workers, tmp_path):
    found = dict(workers.run([Fail(), Answer(1, tmp_path)]))
    assert found[0].status == Status.FAILED and "nobody foresaw this" in found[0].reason
    assert found[1].status == Status.DONE


@pytest.mark.skipif(os.name != "posix", reason="signals are POSIX's")
def test_a_worker_that_is_killed_costs_only_its_task(workers, tmp_path):
    found = dict(workers.run([Answer(0, tmp_path), Die(), Answer(2, tmp_path)]))
    assert (found[1].status, found[1].reason) == (Status.FAILED, KILLED)
    assert [found[k].reason for k in (0, 2)] == ["0", "2"]


def test_an_address_where_nobody_answers_is_told(monkeypatch):
    monkeypatch.setattr(cluster, "CONNECT_S", 0.5)
    with pytest.raises(InvalidInput, match="no Dask scheduler answers"):
        ClusterWorkers("tcp://127.0.0.1:9", 1)
