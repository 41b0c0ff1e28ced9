"""A process that reads damaged files and may die of it.

    python -m benchmarks.robustness.child FOLDER DATA FORMAT:SEED …

Each outcome is a line of its own, with the processor's seconds where the file was read or refused, and so is what
begins: a death is known to be of what began last.
"""

from __future__ import annotations

import shutil
import sys
import time
import traceback
import warnings
from collections.abc import Iterable
from pathlib import Path

from benchmarks.robustness.formats import Format, formats
from benchmarks.robustness.mutations import mutated
from mbkf.errors import MbkfError

MEMORY_BYTES = 1 << 30
"""How much more memory than at the start a reader may ask for."""

READ, REFUSED, IMPOSSIBLE, FOREIGN = "read", "refused", "impossible", "foreign"


def outcome(name: str, one: Format, seed: int, folder: Path) -> str:
    """What becomes of a damaged file; a foreign error with its name and place.

    Args:
        name: Name of the format.
        one: The format.
        seed: Which damage.
        folder: Where the damaged file is put.
    """
    place = folder / f"{name}-{seed}"
    place.mkdir(parents=True, exist_ok=True)
    path = place / one.file.name
    for other in one.beside:
        shutil.copy(other, place)
    path.write_bytes(mutated(one.file.read_bytes(), seed, one.text))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)
            return READ if one.read(path) else IMPOSSIBLE
    except (MbkfError, OSError):
        return REFUSED
    except Exception as error:
        own = [frame for frame in traceback.extract_tb(error.__traceback__) if "mbkf" in frame.filename]
        where = f"{Path(own[-1].filename).name}:{own[-1].lineno}" if own else "?"
        return f"{FOREIGN} {type(error).__name__} in {where}: {' '.join(str(error).split())[:80]}"
    finally:
        shutil.rmtree(place)


def main(words: Iterable[str]) -> None:
    """Reads what the words name, a line before and after each."""
    folder, data, *asked = words
    known = formats(Path(folder), Path(data) if data else None)
    for name in {word.split(":")[0] for word in asked}:
        known[name].read(known[name].file)  # what a reader imports is no part of what a file costs
    _limit_memory()
    for word in asked:
        name, seed = word.split(":")
        print("begin", word, flush=True)
        begun = time.process_time()
        what = outcome(name, known[name], int(seed), Path(folder) / "damaged")
        took = f" {time.process_time() - begun:.3f}" if what in {READ, REFUSED} else ""
        print("end", word, what + took, flush=True)


def _limit_memory() -> None:
    """Lets no reader take more than :data:`MEMORY_BYTES`, where the system knows such limits."""
    try:
        import resource
    except ImportError:
        return
    pages = int(Path("/proc/self/statm").read_text().split()[0]) if Path("/proc/self/statm").exists() else 0
    if pages:
        most = pages * resource.getpagesize() + MEMORY_BYTES
        resource.setrlimit(resource.RLIMIT_AS, (most, most))


if __name__ == "__main__":
    main(sys.argv[1:])
