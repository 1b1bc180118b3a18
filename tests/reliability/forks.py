"""Trials of forks at any moment of the first calls of a process, while another thread makes them."""

from pathlib import Path
from random import Random

from tests.reliability.processes import run
from tests.reliability.rig import CRASHED, GOOD, HUNG, WRONG, Trial, Verdict

FIRST_CALLS = {
    "evaluate": 'dx.evaluate(["a_C_wrt_ec_BC", "j_C"], theta=theta, threads=2, **design)["j_C"]',
    "evaluate under a load": 'dx.evaluate("T_in", theta=theta, F_Y=dx.over_theta([0.0, 1.0, 2.0], '
    "[1.0, 2.0, 1.0]), threads=2, **design)",
    "grid": 'dx.grid("a_C", theta=theta, ec=["0 mm", "10 mm"], threads=2, **others)["a_C"].values',
    "reduced grid": 'dx.grid("V_C", theta=theta, ec=offsets[:9], reduce={"theta": "max"}, **others)'
    '["V_C_max"].values',
    "peak": 'dx.peak("a_C", ec=offsets, threads=2, **others)["value"]',
    "simulate": "dx.simulate(torque=lambda t, theta, omega: 1.0 - omega, t_end=0.1, I_crank=0.01, "
    'AB=0.125, BC=0.35, ec=0.01)["theta"]',
    "simulate many": "dx.simulate(torque=1.0, t_end=0.1, I_crank=0.01, AB=0.125, BC=0.35, ec=offsets[:50])"
    '["theta"]',
    "simulate many under a table": "dx.simulate(torque=dx.over_theta([0.0, 2.0, 4.0], [1.0, 2.0, 1.0]), "
    'I_crank=0.01, t_end=0.1, AB=0.125, BC=0.35, ec=offsets[:50])["theta"]',
    "simulate many under a function": "dx.simulate(torque=lambda t, theta, omega: 1.0 - 0.01 * omega, "
    'I_crank=0.01, t_end=0.1, AB=0.125, BC=0.35, ec=offsets[:50])["theta"]',
    "sensitivities of many": 'dx.simulate(torque=1.0, wrt=["ec", "torque"], t_end=0.1, I_crank=0.01, '
    'AB=0.125, BC=0.35, ec=offsets[:50])["theta_wrt_ec"]',
    "peak under a load": 'dx.peak("T_in", ec=offsets, F_Y=dx.over_theta([0.0, 2.0, 4.0], [1.0, 2.0, 1.0]), '
    'threads=2, **others)["value"]',
    "function": 'dx.function("a_C", **design)(theta)',
}
START = """
import os, signal, sys, threading, time
import numpy as np
import desaxe as dx
others = dict(AB=0.125, BC=0.35, omega0=157.08)
design = dict(ec=0.01, **others)
theta, offsets = np.linspace(0.0, 6.0, 400_001), np.linspace(0.0, 0.1, 20_000)
"""
# Whoever does not make the first call forks: the main thread, or another.
PROGRAM = """
SECONDS = {seconds}

def first():
    return {first}

def again():
    return {again}

def forked():
    children = []
    for moment in {moments}:
        time.sleep(max(begun + moment - time.monotonic(), 0.0))
        number = os.fork()
        if not number:
            os._exit(0 if np.isfinite(again()).all() else 3)
        children.append(number)
    end = time.monotonic() + SECONDS
    for number in children:
        done = 0
        while not done and time.monotonic() < end:
            done, status = os.waitpid(number, os.WNOHANG)
            time.sleep(0.02)
        if not done:
            os.kill(number, signal.SIGKILL)
            os.waitpid(number, 0)
        codes.append(os.waitstatus_to_exitcode(status) if done else "hung")

codes = []
begun = time.monotonic()
here, there = (first, forked) if {by_thread} else (forked, first)
other = threading.Thread(target=there)
other.start()
here()
other.join()
print(*codes, flush=True)
"""
SECONDS = 120.0  # for the children of a process, which compile anew, all at the same time
MOMENTS = 4  # at which a process forks
LATEST = 4.0  # seconds after its start


def fork_in_first_calls(folder: Path, random: Random) -> Verdict:
    """Forks at random moments of a first call: each child ends, with values."""
    first, again = random.choice(list(FIRST_CALLS)), random.choice(list(FIRST_CALLS))
    moments = sorted(random.uniform(0.0, LATEST) for _ in range(MOMENTS))
    program = START + PROGRAM.format(
        first=FIRST_CALLS[first],
        again=FIRST_CALLS[again],
        moments=moments,
        seconds=SECONDS,
        by_thread=random.random() < 0.5,
    )
    code, out, error = run(program, SECONDS + 120.0)
    message = f"{first}, then {again} after {', '.join(f'{moment:.3f}' for moment in moments)} s"
    if code is None or "hung" in out:
        return Verdict(HUNG, f"{message}: {out}")
    if code:
        return Verdict(CRASHED, f"{message}: {code} {error[-300:]}")
    return GOOD if out.split() == ["0"] * MOMENTS else Verdict(WRONG, f"{message}: {out} {error[-300:]}")


TRIALS = [Trial(f"{MOMENTS} forks in the first calls of a process", fork_in_first_calls, 0, 50)]
