"""The same tasks on a Dask cluster: of one computer, by SSH, or of a queue's nodes, by the scheduler's address.

Workers read the captures and write the results themselves, so folders must be the same on every computer.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from mbkf.errors import InvalidInput, MissingDependency
from mbkf.study.batch.outcome import Outcome, Status, Task, failed
from mbkf.study.batch.progress import Watch
from mbkf.study.batch.worker_process import KILLED, ONE_THREAD

LOCAL = "local"
"""Instead of an address: a cluster on this computer."""

CONNECT_S = 30.0

AHEAD = 4
"""So many tasks per worker are handed over before one is awaited: the way to a worker may be long."""

OWN_CLUSTER = {
    "distributed.nanny.pre-spawn-environ": ONE_THREAD,
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.system-monitor.interval": "5s",
    "distributed.worker.memory.monitor-interval": "1s",
}
"""Dask's settings for a cluster on this computer. By default its workers look at themselves every 10 to 20 ms, and hand
memory back (MALLOC_TRIM_THRESHOLD_) that the next frame asks for again; both together cost a tenth of a trial."""


class ClusterWorkers:
    """Workers of a Dask cluster."""

    def __init__(self, address: str, workers: int) -> None:
        """Connects.

        Args:
            address: Of the scheduler, or :data:`LOCAL`.
            workers: Processes of a local cluster.

        Raises:
            MissingDependency: ``dask.distributed`` is not installed.
            InvalidInput: No scheduler answers there.
        """
        try:
            import dask.config
            import distributed
        except ImportError as error:
            raise MissingDependency("distributed", "a Dask cluster", "cluster") from error
        self._distributed: Any = distributed
        self._cluster: Any = None
        if address == LOCAL:
            with dask.config.set(OWN_CLUSTER):
                self._cluster = distributed.LocalCluster(
                    n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=None
                )
        try:
            self._client: Any = distributed.Client(self._cluster or address, timeout=CONNECT_S)
        except (OSError, ValueError) as error:
            raise InvalidInput(f"no Dask scheduler answers at {address} ({error})") from error

    def run(self, tasks: Iterable[Task], watch: Watch | None = None) -> Iterator[tuple[int, Outcome]]:
        """Outcomes as they come, each with its task's place in the order given; progress inside tasks stays there."""
        del watch
        waiting, places = enumerate(tasks), {}
        done = self._distributed.as_completed()
        most = AHEAD * max(1, sum(self._client.nthreads().values()))
        while True:
            for number, task in waiting:
                future = self._client.submit(task, pure=False)
                places[future.key] = number
                done.add(future)
                if len(places) >= most:
                    break
            if not places:
                return
            future = next(done)
            yield places.pop(future.key), self._outcome(future)

    def close(self) -> None:
        """Lets go of the cluster; one of this computer ends."""
        self._client.close()
        if self._cluster is not None:
            self._cluster.close()

    def _outcome(self, future: Any) -> Outcome:
        error = future.exception()
        if error is None:
            found: Outcome = future.result()
            return found
        if isinstance(error, self._distributed.KilledWorker):
            return Outcome(Status.FAILED, KILLED)
        return failed(error)
