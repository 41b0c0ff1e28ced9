"""Parts of NumPy that no command uses wait until something in them is asked for; each test in a process of its own."""

import subprocess
import sys

import pytest

from mbkf.numerics.postponed import UNUSED

WAITS = """
def waits(name):
    return type(sys.modules["numpy." + name]).__name__ == "_LazyModule"
"""


def printed(*lines):
    """Words that a fresh process prints."""
    program = "\n".join(["import sys", WAITS, "from mbkf.numerics.postponed import postpone", *lines])
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    return done.stdout.split()


def test_scipy_does_not_wake_them():
    names = f"[name for name in {UNUSED} if waits(name)]"
    found = printed("import numpy", "postpone()", "import scipy.linalg", f"print(*{names})")
    assert set(found) == set(UNUSED)


@pytest.mark.parametrize(
    ("name", "asked"),
    [
        ("ma", "numpy.ma.array([1, 2], mask=[0, 1]).sum() == 1"),
        ("testing", "callable(numpy.testing.assert_allclose)"),
        ("polynomial", "numpy.polynomial.Polynomial([1, 2])(3) == 7"),
        ("ctypeslib", "callable(numpy.ctypeslib.as_array)"),
        ("f2py", "callable(numpy.f2py.get_include)"),
    ],
)
def test_a_module_is_there_at_its_first_use(name, asked):
    shows = f"print(waits('{name}'), {asked}, waits('{name}'))"
    assert printed("import numpy", "postpone()", shows) == ["True", "True", "False"]


def test_a_module_that_is_loaded_stays_as_it_is():
    found = printed(
        "import numpy, numpy.testing as before",
        "postpone()",
        "print(numpy.testing is before, waits('testing'))",
    )
    assert found == ["True", "False"]


def test_without_numpy_nothing_is_loaded():
    found = printed("postpone()", "print([name for name in sys.modules if name.startswith('numpy')])")
    assert found == ["[]"]
