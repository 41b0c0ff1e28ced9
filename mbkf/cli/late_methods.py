"""Compiles the methods of mbkf's dataclasses when they are first called, in the process of a command.

Python 3.11 and 3.12 compile each method by itself, six for a frozen class, which takes 0.6 ms a class; a command loads
some two hundred classes, and calls few of their methods. Later versions compile those of a class together and are left
as they are.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

PACKAGE = "mbkf."
COMPILER = "_create_fn"
"""Name of the function of :mod:`dataclasses` that compiles a method: (name, arguments, body, options) -> the method."""


def compile_late() -> None:
    """From here on, dataclasses of mbkf's modules get methods that compile themselves at the first call."""
    create = getattr(dataclasses, COMPILER, None)
    if create is not None:
        setattr(dataclasses, COMPILER, _late(create))


def _late(create: Callable[..., Any]) -> Callable[..., Any]:
    def create_late(name: str, *text: Any, **options: Any) -> Any:
        module = (options.get("globals") or {}).get("__name__", "")
        if not module.startswith(PACKAGE):
            return create(name, *text, **options)
        return _Method(create, name, text, options).first_call()

    return create_late


class _Method:
    """A method that is not compiled yet."""

    def __init__(
        self, create: Callable[..., Any], name: str, text: tuple[Any, ...], options: dict[str, Any]
    ) -> None:
        self._create, self._name, self._text, self._options = create, name, text, options
        self._compiled: Callable[..., Any] | None = None

    def first_call(self) -> Callable[..., Any]:
        """The function that stands in the class until it is called: it compiles the method and takes its place."""

        def method(self_: object, /, *values: object, **named: object) -> object:
            compiled = self._compiled or self._compile()
            for owner in type(self_).__mro__:
                if owner.__dict__.get(self._name) is method:
                    type.__setattr__(owner, self._name, compiled)
            return compiled(self_, *values, **named)

        method.__name__ = self._name
        return method

    def _compile(self) -> Callable[..., Any]:
        self._compiled = self._create(self._name, *self._text, **self._options)
        return self._compiled
