"""jax: compiled by XLA, and where there is no derivative."""

import pytest

from desaxe.compiler.languages.jax import Jax
from tests.compiler.coverage_set import NAMES, POINTS, coverage
from tests.compiler.languages.modules import written, wrong_names
from tests.compiler.languages.tools import imported, jax_in_doubles


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    with jax_in_doubles():
        yield imported(written(Jax(), coverage(), tmp_path_factory.mktemp("jax")))


@pytest.mark.thorough
def test_the_coverage_set_compiled_by_xla(made):
    import jax

    compiled = jax.jit(made.evaluate)
    for point in POINTS:
        assert not wrong_names({n: float(v) for n, v in compiled(**point).items()}, point), point


def test_what_has_no_derivative_says_so(made):
    import jax

    with pytest.raises(NotImplementedError, match="size has no derived derivative with respect to x"):
        jax.grad(made.size)(1.0, 2.0, 3.0)
    assert float(jax.grad(made.size, 2)(1.0, 2.0, 3.0)) == 0.0  # it does not depend on z
    assert set(made.OUTPUTS) == set(NAMES)
