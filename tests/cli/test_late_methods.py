"""Methods of mbkf's dataclasses that are compiled at their first call behave as those compiled with their class."""

import dataclasses
import subprocess
import sys

import pytest

from mbkf.cli.late_methods import COMPILER, compile_late

pytestmark = pytest.mark.skipif(not hasattr(dataclasses, COMPILER), reason="compiled together with the class")


@pytest.fixture
def compiled(monkeypatch):
    """Names of the methods that have been compiled, with methods of mbkf's modules compiled late."""
    names, create = [], getattr(dataclasses, COMPILER)

    def counted(name, *text, **options):
        names.append(name)
        return create(name, *text, **options)

    monkeypatch.setattr(dataclasses, COMPILER, counted)
    compile_late()
    return names


def point(module="mbkf.conventions"):
    fields = [("x", float), ("y", float, dataclasses.field(default=2.0))]
    made = type("Point", (), {"__module__": module, "__annotations__": {one[0]: one[1] for one in fields}})
    made.y = fields[1][2]
    return dataclasses.dataclass(frozen=True, order=True)(made)


def test_a_method_is_compiled_once_when_it_is_first_called(compiled):
    made = point()
    assert compiled == []
    one, other = made(1.0), made(x=1.0, y=3.0)
    assert compiled == ["__init__"]
    assert one != other and one == made(1.0, 2.0) and one < other
    assert hash(one) == hash(made(1.0)) != hash(other)
    assert repr(one) == repr(made(1.0)) == "Point(x=1.0, y=2.0)"
    assert sorted(compiled) == ["__eq__", "__hash__", "__init__", "__lt__", "__repr__"]


def test_a_frozen_class_stays_frozen(compiled):
    one = point()(1.0)
    for change in (lambda: setattr(one, "x", 2.0), lambda: delattr(one, "x")):
        with pytest.raises(dataclasses.FrozenInstanceError):
            change()
    assert dataclasses.asdict(dataclasses.replace(one, x=4.0)) == {"x": 4.0, "y": 2.0}


def test_a_wrong_argument_is_refused_with_the_name_of_the_method(compiled):
    with pytest.raises(TypeError, match=r"Point.__init__\(\) got an unexpected keyword argument 'z'"):
        point()(1.0, z=3.0)


def test_a_subclass_calls_the_method_of_its_base(compiled):
    base = point()

    class Derived(base):
        def __init__(self):
            super().__init__(1.0, y=5.0)

    assert (Derived().x, Derived().y, base(1.0).y) == (1.0, 5.0, 2.0)
    assert compiled == ["__init__"] and Derived.__init__.__module__ == __name__


def test_classes_of_other_packages_are_compiled_at_once(compiled):
    point("dataclasses")
    assert "__init__" in compiled and "__eq__" in compiled


def test_the_command_compiles_late():
    code = [
        "import dataclasses, sys",
        "from mbkf.__main__ import main",
        "try:",
        "    main()",
        "except SystemExit:",
    ]
    code += [f"    print(dataclasses.{COMPILER}.func.__module__, file=sys.stderr)"]
    words = [sys.executable, "-c", "\n".join(code), "--help"]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert done.stderr.split() == ["mbkf.cli.late_methods"]
