"""A user's function of a design that gives its value and its derivatives, for many designs."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class OwnMeasure:
    """A user's function of a design (a dict of parameters) that returns a value and a dict of derivatives."""

    def __init__(self, function: Any) -> None:
        self.function = function
        self.name = getattr(function, "__name__", "function")

    def __call__(self, designs: Mapping[str, Any]) -> tuple[Array, dict[str, Array]]:
        """Values and derivatives of designs, one after the other."""
        numbers = {p: np.asarray(v, float) for p, v in designs.items() if v is not None and not callable(v)}
        shape = np.broadcast_shapes(*(v.shape for v in numbers.values()))
        rows = {p: np.broadcast_to(v, shape).reshape(-1) for p, v in numbers.items()}
        size = int(np.prod(shape))
        answers = [self._one({p: float(v[row]) for p, v in rows.items()}) for row in range(size)]
        value = np.array([answer[0] for answer in answers]).reshape(shape)
        names = dict.fromkeys(p for _, gradient in answers for p in gradient)
        return value, {
            p: np.array([gradient.get(p, 0.0) for _, gradient in answers]).reshape(shape) for p in names
        }

    def _one(self, design: dict[str, float]) -> tuple[float, Mapping[str, float]]:
        try:
            value, gradient = self.function(design)
            return float(value), {p: float(slope) for p, slope in gradient.items()}
        except (TypeError, ValueError, AttributeError) as error:
            raise TypeError(
                f"{self.name}(design) must give (value, {{parameter: derivative}}) of numbers: {error}"
            ) from error
