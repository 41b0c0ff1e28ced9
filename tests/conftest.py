"""Fixtures shared by all tests."""

import os
from pathlib import Path

import pytest

from mbkf.numerics.threads import single_threaded

STUDIES = Path(__file__).parent / "benchmarks"


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tests of benchmarks repeat parts of studies, and so are slow."""
    for item in items:
        if item.path.is_relative_to(STUDIES):
            item.add_marker(pytest.mark.slow)


@pytest.fixture(scope="session")
def real_data() -> Path:
    """Folder of the public reference captures, named by the environment variable MBKF_DATA.

    Where it is not set a test is skipped, except in continuous integration (CI set), where it fails.
    """
    named = os.environ.get("MBKF_DATA", "")
    if not named and not os.environ.get("CI"):
        pytest.skip("MBKF_DATA is not set; it names the folder of the public reference captures")
    folder = Path(named or "MBKF_DATA is not set")
    if not folder.is_dir():
        pytest.fail(f"no folder of reference captures: {folder}")
    return folder


@pytest.fixture(scope="session", autouse=True)
def one_thread():
    """Small matrices on one thread, as the pipelines run them."""
    with single_threaded():
        yield
