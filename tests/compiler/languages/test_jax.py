"""The jax column: each operation, each way to nest two, as it stands and compiled by XLA."""

import pytest

from desaxe.compiler.languages.jax import Jax
from tests.compiler.coverage_set import NAMES, POINTS, coverage
from tests.compiler.languages.modules import module, wrong_names
from tests.compiler.languages.tools import imported, jax_in_doubles


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    place = tmp_path_factory.mktemp("jax") / "made.py"
    place.write_text(Jax().files(module(coverage()))["made.py"], encoding="utf-8")
    with jax_in_doubles():
        yield imported(place)


@pytest.mark.thorough
def test_the_coverage_set_against_exact(made):
    import jax

    compiled = jax.jit(made.evaluate)
    for point in POINTS:
        for evaluate in (made.evaluate, compiled):
            assert not wrong_names({n: float(v) for n, v in evaluate(**point).items()}, point), point


def test_what_has_no_derivative_says_so(made):
    import jax

    with pytest.raises(NotImplementedError, match="size has no derived derivative by x"):
        jax.grad(made.size)(1.0, 2.0, 3.0)
    assert float(jax.grad(made.size, 2)(1.0, 2.0, 3.0)) == 0.0  # it does not depend on z
    assert set(made.OUTPUTS) == set(NAMES)
