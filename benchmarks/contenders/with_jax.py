"""JAX: the lambdified code under `jit`, in doubles, compiled ahead for these shapes."""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np

from ..formulas import lambdified
from ..work import Array, Inputs, Work, swept
from . import Run

jax.config.update("jax_enable_x64", True)


def prepare(work: Work, inputs: Inputs, out: Sequence[Array] | None, threads: int) -> Run:
    """The inputs are on JAX's device already; it allocates its results, and uses the process's cores."""
    del out, threads
    points = swept(inputs, theta_first=False) if work.kind == "peak" else inputs
    function = lambdified(work.names, points, "jax")

    def peak(*columns: jax.Array) -> tuple[jax.Array, jax.Array]:
        magnitude = jnp.abs(function(*columns)[0])
        where = magnitude.argmax(axis=1)
        return jnp.take_along_axis(magnitude, where[:, None], 1)[:, 0], columns[-1][where]

    columns = [jax.device_put(column) for column in points.broadcast().values()]
    compiled = jax.jit(peak if work.kind == "peak" else function).lower(*columns).compile()

    def run() -> Sequence[Array]:
        answers = jax.block_until_ready(compiled(*columns))
        return [np.asarray(answer) for answer in answers]

    return run
