"""Every function of the kernel takes arguments as they are declared, and refuses all others by name."""

import pytest

from mbkf.kernel.declaration import fingerprint, requires, unlocked
from mbkf.kernel.loading import library
from tests.kernel.declared import DECLARED, DTYPES, ROOT, Call

needs_kernel = pytest.mark.skipif(library() is None, reason="the kernel is not compiled here")

FUNCTIONS = DECLARED.functions


@needs_kernel
@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_takes_what_is_declared_and_gives_it_back(name):
    call = Call(name)
    found, made = call.result(), FUNCTIONS[name].made
    results = found if isinstance(found, tuple) else (found,)
    own = FUNCTIONS[name].returned
    for value, result in zip(made, results[len(results) - len(made) :], strict=True):
        if value.type in DTYPES:
            assert result.dtype == DTYPES[value.type]
            assert result.shape == tuple(call._of(size) for size in value.sizes)
            assert result.flags.f_contiguous if value.order == "fortran" else result.flags.c_contiguous
    if own in ("int", "float", "bool"):
        assert type(results[0]).__name__ == own
    assert len(results) == len(made) + (own != "void") or results == (None,)


@needs_kernel
@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("seed", [0, 1])
def test_every_fault_in_every_argument_is_refused_by_name(name, seed):
    faults = list(Call(name, seed).faults())
    assert len(faults) > len(FUNCTIONS[name].arguments)
    for fault in faults:
        with pytest.raises(fault.error) as refused:
            getattr(library(), name)(*fault.arguments)
        missing = [word for word in fault.named if word not in str(refused.value)]
        assert not missing, f"{missing} not in '{refused.value}'"


@needs_kernel
@pytest.mark.parametrize(
    ("name", "condition"),
    [(name, condition) for name, one in FUNCTIONS.items() for condition in one.requires],
)
def test_sizes_that_break_a_condition_are_refused(name, condition):
    call = Call(name, broken=condition)
    with pytest.raises(ValueError, match=f"{name}: .*is required; got") as refused:
        call.result()
    assert condition in str(refused.value)


@needs_kernel
def test_integers_are_not_read_as_numbers():
    """As happened once: 5e-324 in silence."""
    import numpy as np

    with pytest.raises(TypeError, match=r"correction: vector must hold float64.*got int64"):
        library().correction(np.eye(6), np.ones(3, np.int64), np.zeros((1, 6)), np.zeros(1))


def test_decorators_leave_a_function_as_it_is():
    def function():
        pass

    assert unlocked(function) is function
    assert requires("n <= N")(function) is function


def test_the_fingerprint_is_that_of_the_declarations():
    assert fingerprint(ROOT / "mbkf" / "kernel") == DECLARED.fingerprint
