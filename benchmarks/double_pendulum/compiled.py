"""CasADi expressions as plain functions of numpy arrays, without the conversions that take most of a small call."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from mbkf.conventions import Array


class Compiled:
    """A CasADi function of dense arrays that writes into its own buffers; every call returns new arrays.

    Attributes:
        function: The CasADi function itself.
    """

    def __init__(self, name: str, inputs: Sequence[ca.SX], outputs: Sequence[ca.SX]) -> None:
        """Compiles it.

        Args:
            name: Name of the function.
            inputs: Symbols of its inputs.
            outputs: Expressions of its outputs.
        """
        self.function = ca.Function(name, list(inputs), [ca.densify(output) for output in outputs])
        # CasADi's own annotations of these two know neither memory views nor that sizes follow from them.
        buffer: Any
        buffer, self._evaluate = self.function.buffer()
        self._buffer = buffer
        self._inputs = [np.zeros(one.numel()) for one in inputs]
        self._outputs = [np.zeros(one.numel()) for one in outputs]
        # A column is an array of one axis; CasADi stores matrices column by column.
        self._shapes = [one.shape if one.shape[1] > 1 else (one.shape[0],) for one in outputs]
        for place, values in enumerate(self._inputs):
            buffer.set_arg(place, memoryview(values.data))
        for place, values in enumerate(self._outputs):
            buffer.set_res(place, memoryview(values.data))

    def __call__(self, *values: Array) -> list[Array]:
        """One array per output, for one array per input."""
        for mine, given in zip(self._inputs, values, strict=True):
            mine[:] = given
        self._evaluate()
        return [
            mine.copy().reshape(shape, order="F")
            for mine, shape in zip(self._outputs, self._shapes, strict=True)
        ]
