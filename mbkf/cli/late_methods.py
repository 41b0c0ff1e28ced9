"""Compiles the methods of mbkf's dataclasses when they are first called, in the process of a command.

Python 3.11 and 3.12 compile each method by itself, six for a frozen class, which takes 0.6 ms a class; a command loads
some two hundred classes, and calls few of their methods. Later versions compile those of a class together and are left
as they are. Until its first call a method's signature reads ``(*values, **named)``.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from functools import cache, partial
from typing import Any

PACKAGE = "mbkf."
COMPILER = "_create_fn"
"""Name of the function of :mod:`dataclasses` that compiles a method: (name, arguments, body, options) -> the method."""


def compile_late() -> None:
    """From here on, dataclasses of mbkf's modules get methods that compile themselves at the first call."""
    create = getattr(dataclasses, COMPILER, None)
    if create is not None:
        setattr(dataclasses, COMPILER, partial(_create_late, create))


def _create_late(create: Callable[..., Any], name: str, *text: Any, **options: Any) -> Any:
    """A function that stands in the class until it is called: it compiles the method, which takes its place."""
    if not (options.get("globals") or {}).get("__name__", "").startswith(PACKAGE):
        return create(name, *text, **options)
    compiled = cache(partial(create, name, *text, **options))

    def method(self_: object, /, *values: object, **named: object) -> object:
        found = compiled()
        found.__qualname__ = method.__qualname__
        for owner in type(self_).__mro__:
            if owner.__dict__.get(name) is method:
                type.__setattr__(owner, name, found)
        return found(self_, *values, **named)

    method.__name__ = method.__qualname__ = name
    return method
