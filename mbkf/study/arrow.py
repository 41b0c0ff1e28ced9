"""Apache Arrow, in which tables over many trials are made; the extra ``study`` brings it."""

from __future__ import annotations

from mbkf.errors import MissingDependency

try:
    import pyarrow as pa
    import pyarrow.csv as pa_csv
    import pyarrow.parquet as pq
except ModuleNotFoundError as error:
    raise MissingDependency(
        "pyarrow", "a table over trials (mbkf batch, mbkf app, mbkf report --curves)", "study"
    ) from error

__all__ = ["pa", "pa_csv", "pq"]
