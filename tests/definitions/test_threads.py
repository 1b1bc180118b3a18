"""Own quantities while others define: each call has one state of them, a scene and a machine their own."""

import pickle
import threading
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest

import desaxe as dx
from desaxe.mechanism import own
from tests.effort import cases

POINT = {"theta": 1.0, "ec": 0.01, "AB": 0.05, "BC": 0.2, "omega0": 10.0}
LENGTHS = {"ec": 0.01, "AB": 0.05, "BC": 0.2}
V = dx.evaluate("V_C", **POINT)


@pytest.fixture(autouse=True)
def nothing_defined():
    before = own.definitions()
    yield
    own.change(lambda _: before)


def tables(factor, **more):
    """A scene whose own quantity is a multiple of the speed."""
    return {
        "outputs": ["twin", "V_C", "twin_wrt_ec", "V_C_wrt_ec"],
        "mechanism": LENGTHS,
        "motion": {"theta": [0.5, 1.0, 2.0], "omega0": 10.0},
        "quantities": {"twin": {"expression": f"{factor}*V_C", "meaning": f"{factor} times"}},
        "peak": [{"quantity": "twin", "over": {"BC": [0.2, 0.21]}}],
        "check": [{"printed": {"twin": "0"}, "at": {"theta": 1.0}}],
        **more,
    }


def in_threads(*works):
    """Run functions at the same time; the first failure is raised."""
    with ThreadPoolExecutor(len(works)) as pool:
        return [done.result() for done in [pool.submit(work) for work in works]]


@pytest.mark.sampled
def test_scenes_of_the_same_names_run_in_threads():
    peak = dx.peak("V_C", **{k: POINT[k] for k in (*LENGTHS, "omega0")})["value"]

    def run(factor):
        kept = dx.scene(tables(factor))
        for turn in range(cases(5, 100, 400)):
            scene = dx.scene(tables(factor)) if turn % 2 else kept
            result = scene.run()
            np.testing.assert_allclose(result.dataset.twin, factor * result.dataset.V_C, rtol=1e-14)
            np.testing.assert_allclose(
                result.dataset.twin_wrt_ec, factor * result.dataset.V_C_wrt_ec, rtol=1e-13
            )
            assert result.peaks[0].dataset["value"].values[0] == pytest.approx(factor * peak, rel=1e-12)
            assert result.checks[0].computed == pytest.approx(factor * V, rel=1e-13)
            assert f"{factor}*V_C" in result.dataset.attrs["quantities"]

    in_threads(*(lambda k=k: run(k) for k in (2, 3, 5)))


@pytest.mark.sampled
def test_define_in_threads():
    dx.define("untouched", "7*V_C")
    over = threading.Event()

    def change(number):
        for turn in range(cases(10, 400, 2000)):
            factor = 2 + turn % 5
            dx.define(f"mine_{number}", f"{factor}*V_C")
            assert dx.evaluate(f"mine_{number}", **POINT) == pytest.approx(factor * V, rel=1e-14)
            names = [f"mine_{number}", "untouched"]
            assert dx.evaluate(names, **POINT)["untouched"] == pytest.approx(7 * V, rel=1e-14)
            if turn % 7 == 0:
                dx.undefine(f"mine_{number}")

    def read():
        while not over.is_set():
            assert dx.evaluate("untouched", **POINT) == pytest.approx(7 * V, rel=1e-14)
            assert "untouched" in dx.quantities()

    reader = ThreadPoolExecutor(1).submit(read)
    in_threads(*(lambda k=k: change(k) for k in range(6)))
    over.set()
    reader.result()


def test_a_pool_sees_what_is_defined():
    dask = pytest.importorskip("dask.array")
    pool = ThreadPoolExecutor(1)
    pool.submit(int).result()  # its thread is there before
    for factor in (2, 3):
        dx.define("mine", f"{factor}*V_C")
        assert pool.submit(dx.evaluate, "mine", **POINT).result() == pytest.approx(factor * V, rel=1e-14)
        theta = dask.from_array(np.full(4, 1.0), chunks=2)
        lazy = theta.map_blocks(lambda t: dx.evaluate("mine", **POINT | {"theta": t}))
        np.testing.assert_allclose(lazy.compute(scheduler="threads"), factor * V, rtol=1e-14)


def in_another_process(work):
    """The answer of a function or a scene there, where nothing was defined."""
    thing, inputs = pickle.loads(work)
    return thing.run().dataset.twin.values.tolist() if inputs is None else thing(**inputs)


@pytest.mark.thorough
def test_definitions_travel_with_what_was_made():
    scenes = [dx.scene(tables(factor)) for factor in (2, 3)]
    machines = [dx.Machine(tables(factor)) for factor in (2, 3)]
    dx.define("twin", "100*V_C")
    functions = [machine.function("twin") for machine in machines]
    at = {"theta": 1.0}
    for factor, scene, machine, function in zip((2, 3), scenes, machines, functions, strict=True):
        assert machine.evaluate("twin", **at) == pytest.approx(factor * V, rel=1e-14)
        assert machine.replace(omega0=20.0).evaluate("twin", **at) == pytest.approx(2 * factor * V, rel=1e-14)
        again = machine.scene("twin", theta=[1.0]).run()
        assert again.dataset.twin.item() == pytest.approx(factor * V, rel=1e-14)
        assert function(1.0) == pytest.approx(factor * V, rel=1e-14)
        assert scene.run().dataset.twin.values[1] == pytest.approx(factor * V, rel=1e-14)
        assert dx.explain(scene).data["outputs"][0]["meaning"] == f"{factor} times"
    assert machines[0] != machines[1]
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        for factor, scene, machine in zip((2, 3), scenes, machines, strict=True):
            works = [
                (scene, None),
                (machine.evaluate, {"names": "twin", **at}),
                (machine.function("twin"), at),
            ]
            values, value, other = pool.map(in_another_process, map(pickle.dumps, works))
            assert values[1] == pytest.approx(factor * V, rel=1e-14)
            assert value == other == pytest.approx(factor * V, rel=1e-14)


@pytest.mark.thorough
def test_lazy_results_keep_their_definitions():
    lazy = {}
    load = dx.over_Y([0.1, 0.2, 0.3], [0.0, 100.0, 0.0], kind="step")
    given = {**LENGTHS, "omega0": 10.0, "F_Y": load}
    for factor in (2, 3):
        dx.define("mine", f"{factor}*T_in")
        lazy[factor] = (
            dx.grid("mine", **given, theta=np.linspace(0, 6, 7), chunks={"theta": 3}),
            dx.function("mine", "theta", **LENGTHS, omega0=10.0),
        )
    dx.undefine("mine")
    plain = dx.evaluate("T_in", **given, theta=np.linspace(0, 6, 7))
    for factor, (grid, function) in lazy.items():
        np.testing.assert_allclose(grid.mine.compute(), factor * plain, rtol=1e-13)
        slope = dx.evaluate("T_in_wrt_theta", **LENGTHS, theta=1.0, omega0=10.0)
        assert function.jacobian(1.0)["mine"]["theta"] == pytest.approx(factor * slope, rel=1e-13)
