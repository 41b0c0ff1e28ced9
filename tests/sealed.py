"""Files of HDF5 changed for tests, as programs without a seal wrote them."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

from mbkf.io.hdf5 import USER_BLOCK


@contextmanager
def unsealed(path: Path) -> Iterator[h5py.File]:
    """The file to change; afterwards it has no seal."""
    with h5py.File(path, "a") as file:
        yield file
    content = path.read_bytes()
    path.write_bytes(bytes(USER_BLOCK) + content[USER_BLOCK:])
