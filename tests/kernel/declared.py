"""Calls of the kernel's functions as they are declared, and calls with one fault each."""

import importlib.util
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np

from mbkf.errors import ShapeError
from mbkf.kernel.loading import library

ROOT = Path(__file__).resolve().parents[2]
DTYPES = {"Array": np.float64, "Int32Array": np.int32, "BoolArray": np.bool_}
MOST = 9
FREE_ROOT, PLATES = (7, 6, 2), 2  # nq, nv and joints of the smallest tree; plates of its feet


def declaration_reader():
    """The reader of declarations, which stands outside of the package."""
    spec = importlib.util.spec_from_file_location(
        "kernel_declarations", ROOT / ".ci" / "kernel_declarations.py"
    )
    module = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


DECLARED = declaration_reader().declarations(ROOT / "mbkf" / "kernel")


class Fault(NamedTuple):
    """A call that has to be refused, and what its message has to hold."""

    arguments: list
    error: type[Exception] | tuple[type[Exception], ...]
    named: tuple[str, ...]


class Call:
    """A call of a function with random sizes and numbers that its declaration allows."""

    def __init__(self, name: str, seed: int = 0, broken: str = "") -> None:
        """Chooses sizes; those of a broken condition do not satisfy it, the others do."""
        self.function, self._rng = DECLARED.functions[name], np.random.default_rng(seed)
        self.sizes = self._sizes(broken)
        self.arguments = [self._made(one) for one in self.function.arguments]

    def result(self):
        return getattr(library(), self.function.name)(*self.arguments)

    def faults(self) -> Iterator[Fault]:
        """All of them; array arguments have most."""
        name, given = self.function.name, self.arguments
        if given:
            yield Fault(given[:-1], TypeError, (name,))
        yield Fault([*given, None], TypeError, (name,))
        for at, value in enumerate(self.function.arguments):
            for wrong, error, named in self._wrong(value, given[at]):
                yield Fault([*given[:at], wrong, *given[at + 1 :]], error, (name, *named))

    def _sizes(self, broken: str) -> dict[str, int]:
        """Sizes by rejection."""
        one, fixed = self.function, {"J": 1}
        kinds = {value.type for value in one.arguments}
        if kinds & {"Tree", "Feet"}:
            fixed |= dict(zip(("nq", "nv", "joints"), FREE_ROOT, strict=True))
        if "Feet" in kinds:
            fixed |= {"plates": PLATES, "memory": 9 + 4 * PLATES + 7 * 3}
        free = [*one.sizes, *(value.name for value in one.arguments if value.type == "int")]
        free = [name for name in free if name not in fixed]
        for _ in range(20_000):
            drawn = self._rng.integers(-1 if broken else 1, 4 * MOST, len(free)).tolist()
            sizes = fixed | {
                name: number if name not in one.sizes else max(0, number)
                for name, number in zip(free, drawn, strict=True)
            }
            held = {condition: self._of(condition, sizes) for condition in one.requires}
            if all(true != (condition == broken) for condition, true in held.items()) and self._bounded(
                sizes
            ):
                return sizes
        raise AssertionError(f"{one.name}: no sizes satisfy {one.requires}")

    def _bounded(self, sizes: dict[str, int]) -> bool:
        """Index arrays have a range."""
        bounds = [value.bounds for value in self.function.arguments if value.bounds]
        return all(self._of(low, sizes) < self._of(end, sizes) for low, end in bounds)

    def _of(self, expression: str, sizes: dict[str, int] | None = None) -> int:
        return eval(expression, {}, self.sizes if sizes is None else sizes)

    def _made(self, value):
        """An argument as declared."""
        if value.type in DTYPES:
            shape = [self._of(size.lstrip("*")) for size in value.sizes]
            return self._array(value, shape)
        if value.type in DECLARED.handles:
            return {"Tree": tree, "Feet": feet}[value.type]()
        if value.type in DECLARED.records:
            return SimpleNamespace(
                **{name: kind == "bool" or 1.0 for name, kind in DECLARED.records[value.type].items()}
            )
        return {"int": self.sizes.get(value.name), "float": 1.0, "bool": True}[value.type]

    def _array(self, value, shape):
        if value.name == "joints":  # one joint with all dofs
            return np.array([[0, self._of("nv")]], dtype=np.int32)
        if value.bounds is not None:
            return np.full(shape, self._of(value.bounds[0]), dtype=np.int32)
        if value.order == "symmetric":
            root = self._rng.normal(size=shape)
            return np.eye(len(root)) + root @ root.T
        numbers = self._rng.uniform(0.0, 1.0, shape).astype(DTYPES[value.type])
        if value.name == "before" and self.function.name == "decide_contact":
            numbers[:] = 0.0
        return np.asfortranarray(numbers) if value.order == "fortran" else numbers

    def _wrong(self, value, good) -> Iterator[tuple[object, object, tuple[str, ...]]]:
        """Values that an argument must not have, the error, and names in its message."""
        if value.type in DTYPES:
            yield from self._wrong_arrays(value, good)
        elif value.type in DECLARED.records:
            yield object(), TypeError, (value.name,)
            for name in vars(good):
                yield SimpleNamespace(**vars(good) | {name: "1"}), TypeError, (name,)
        elif value.type in DECLARED.handles:
            other = feet() if value.type == "Tree" else tree()
            yield from ((wrong, TypeError, (value.name,)) for wrong in (None, good.__class__, other))
        else:
            wrongs = {"float": ["1", None], "int": [1.5, None, 2**40], "bool": [1, None, "True"]}[value.type]
            yield from ((wrong, TypeError, (value.name,)) for wrong in wrongs)

    def _wrong_arrays(self, value, good) -> Iterator[tuple[object, object, tuple[str, ...]]]:
        other = {
            np.float64: (np.float32, np.int64, complex),
            np.int32: (np.int64, float),
            np.bool_: (np.uint8,),
        }
        wrongs = [good.tolist(), *(good.astype(kind) for kind in other[DTYPES[value.type]])]
        if good.size and value.type != "BoolArray":
            shifted = np.frombuffer(b" " + good.tobytes(), np.uint8)[1:].view(good.dtype).reshape(good.shape)
            wrongs += [good.astype(good.dtype.newbyteorder()), shifted]
        if not value.optional:
            wrongs.append(None)
        if value.role == "Out":
            wrongs.append(good.copy(order="K"))
            wrongs[-1].setflags(write=False)
        if good.size > 1:
            apart = np.repeat(good, 2, axis=-1)[..., ::2]
            wrongs.append(apart)
            if value.order != "symmetric" and sum(length > 1 for length in good.shape) > 1:
                wrongs.append(np.array(good, order="C" if value.order == "fortran" else "F"))
        yield from ((wrong, TypeError, (value.name,)) for wrong in wrongs)
        if not value.sizes[0].startswith("*"):
            yield np.asarray(good[..., None], order="A"), ShapeError, (value.name,)
        elif len(value.sizes) > 1:
            yield good.ravel(), ShapeError, (value.name,)
        for axis, size in enumerate(value.sizes):
            if self._is_shared(value, size):
                longer = np.concatenate([good, good.take([0], axis)], axis) if good.shape[axis] else None
                if longer is not None:
                    longer = np.array(longer, order="F" if value.order == "fortran" else "C")
                    yield longer, (ShapeError, ValueError), ()
        if value.bounds is not None and good.size:
            for wrong in (self._of(value.bounds[0]) - 1, self._of(value.bounds[1])):
                outside = good.copy()
                outside.flat[-1] = wrong
                yield outside, ValueError, (value.name,)

    def _is_shared(self, value, size: str) -> bool:
        """True if something else than this dimension sets or uses the size, too."""
        plain = size.lstrip("*")
        if not plain.isidentifier() or plain not in self.function.sizes:
            return True
        others = (other for one in self.function.arguments for other in one.sizes)
        uses = [other for other in others if plain in re.findall(r"\w+", other)]
        return len(uses) > 1


def tree():
    """Handle of a free body without mass."""
    (nq, nv, joints), none = FREE_ROOT, np.zeros(2, dtype=np.int32)
    matrices, vectors = np.zeros((joints, 3, 3)), np.zeros((joints, 3))
    return library().make_tree(
        nq, nv, none, none, none, none, vectors, matrices, vectors, np.zeros(joints), vectors, matrices, np.zeros(6)
    )  # fmt: skip


def feet():
    """Handle of feet on that body."""
    call = Call("make_feet", seed=1)
    by_name = dict(zip((one.name for one in call.function.arguments), call.arguments, strict=True))
    K, by_name["window"] = PLATES, 3
    by_name |= {"plate_known": np.ones(K, bool), "plate_least_n": np.ones(K), "plate_surface_m": np.ones(K)}
    by_name |= {"plate_box": np.ones((K, 4)), "plate_edges": np.ones((K, 4, 4))}
    return library().make_feet(*by_name.values())
