"""Fixtures shared by all tests."""

import gc
import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from mbkf.cli.main import GARBAGE_AFTER
from mbkf.io.capture import CAPTURES, FORCES
from mbkf.io.imu.files import IMUS
from mbkf.kernel.loading import COMPILED, REFERENCE, SWITCH, library
from mbkf.numerics.threads import single_threaded

STUDIES = Path(__file__).parent / "benchmarks"
# programs that tests start compute on one thread, too
os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
# an example is judged by its result, not by how busy the computer is
settings.register_profile("patient", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("patient")


def pytest_configure(config: pytest.Config) -> None:
    """Processes take files as they are listed: by their number of tests, long files of few tests would come last."""
    if hasattr(config.option, "loadscopereorder"):
        config.option.loadscopereorder = False


def pytest_sessionstart() -> None:
    """Nothing that collects tests is garbage."""
    gc.disable()


def pytest_collection_finish() -> None:
    """Circles of references are looked for as in a command, and not among thousands of collected tests."""
    gc.freeze()
    gc.set_threshold(GARBAGE_AFTER)
    gc.enable()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tests of benchmarks repeat parts of studies, and so are slow; files with slow tests come first.

    Processes that take one file after another end together where the last files are short.
    """
    for item in items:
        if item.path.is_relative_to(STUDIES):
            item.add_marker(pytest.mark.slow)
    slow = {item.path for item in items if item.get_closest_marker("slow")}
    items.sort(key=lambda item: item.path not in slow)


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
    """Small matrices on one thread, as the trial's questions run them."""
    with single_threaded():
        yield


@pytest.fixture(scope="session", autouse=True)
def no_power_cut():
    """Nothing waits for the disk: what a test writes need not outlast a power cut."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda _: None)
        yield


@pytest.fixture(scope="module", autouse=True)
def own_caches(request: pytest.FixtureRequest):
    """The cached results of a file of tests end with it: a filter's steps with their covariances hold 900 MB."""
    yield
    for one in vars(request.module).values():
        if hasattr(one, "cache_clear") and one.__module__ == request.module.__name__:
            one.cache_clear()


@pytest.fixture(params=[COMPILED, REFERENCE])
def either_kernel(request, monkeypatch) -> str:
    """The test runs twice: with the compiled kernel, skipped where none is built, and with the reference."""
    monkeypatch.delenv(SWITCH, raising=False)
    library.cache_clear()
    if request.param == COMPILED and library() is None:
        pytest.skip("the kernel is not compiled here")
    monkeypatch.setenv(SWITCH, request.param)
    library.cache_clear()
    yield request.param
    library.cache_clear()


@pytest.fixture
def reference_kernel(monkeypatch) -> None:
    """No compiled kernel, as where none is built."""
    monkeypatch.setenv(SWITCH, REFERENCE)
    library.cache_clear()
    yield
    library.cache_clear()


@pytest.fixture
def registries():
    """Registries that forget what a test adds."""
    before = [(one, list(one)) for one in (CAPTURES, FORCES, IMUS)]
    yield
    for registry, formats in before:
        for added in [one for one in registry if one not in formats]:
            registry.remove(added)
