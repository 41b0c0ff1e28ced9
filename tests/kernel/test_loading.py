"""Which kernel is used: what is built, unless the environment says otherwise."""

import pytest

from mbkf.errors import InvalidInput
from mbkf.kernel import loading
from mbkf.kernel.loading import COMPILED, REFERENCE, SWITCH, kernel_name, library


@pytest.fixture(autouse=True)
def fresh():
    library.cache_clear()
    yield
    library.cache_clear()


def withheld():
    raise ImportError("no module")


def test_the_kernel_is_named(either_kernel):
    assert kernel_name().startswith(either_kernel)
    assert (library() is None) == (either_kernel == REFERENCE)


def test_without_a_built_kernel_the_reference_is_used(monkeypatch):
    monkeypatch.delenv(SWITCH, raising=False)
    monkeypatch.setattr(loading, "_connected", withheld)
    assert library() is None
    assert kernel_name() == "reference kernel (numpy)"


def test_a_kernel_that_is_asked_for_and_not_there_is_an_error(monkeypatch):
    monkeypatch.setenv(SWITCH, COMPILED)
    monkeypatch.setattr(loading, "_connected", withheld)
    with pytest.raises(InvalidInput, match="no module"):
        library()


@pytest.mark.skipif(library() is None, reason="the kernel is not compiled here")
@pytest.mark.parametrize("wanted", ["", COMPILED])
def test_a_kernel_from_other_declarations_is_refused_and_never_left_out_in_silence(monkeypatch, wanted):
    monkeypatch.setenv(SWITCH, wanted)
    monkeypatch.setattr(loading, "fingerprint", lambda folder: "that of a later version")
    with pytest.raises(InvalidInput, match=r"does not match its declaration.*install mbkf again"):
        library()


def test_an_unknown_switch_is_refused(monkeypatch):
    monkeypatch.setenv(SWITCH, "fast")
    with pytest.raises(InvalidInput, match="MBKF_KERNEL=fast"):
        library()
