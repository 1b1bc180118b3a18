"""Trials of processes: forks after threads were used, interrupts at any moment."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from random import Random

from tests.reliability.rig import CRASHED, GOOD, HUNG, WRONG, Trial, Verdict

START = """
import multiprocessing, os, signal, sys, threading, time
import numpy as np
import desaxe as dx
design = dict(ec=0.01, AB=0.125, BC=0.35, omega0=157.08)
theta = np.linspace(0.0, 6.0, 200_000)

def value():
    return float(dx.evaluate("a_C", theta=theta, threads=2, **design).sum())
"""
FORKS = {
    "os.fork": """
number = os.fork()
if not number:
    os._exit(0 if value() == first else 3)
code = os.waitstatus_to_exitcode(os.waitpid(number, 0)[1])
""",
    "Process": """
def work():
    sys.exit(0 if value() == first else 3)
child = multiprocessing.get_context("fork").Process(target=work)
child.start(); child.join(); code = child.exitcode
""",
    "Pool": """
def work(k):
    return value()
with multiprocessing.get_context("fork").Pool(2) as pool:
    code = 0 if set(pool.map(work, range(4))) == {first} else 3
""",
    "while a thread computes": """
other = threading.Thread(target=lambda: [value() for _ in range(20)])
other.start()
number = os.fork()
if not number:
    os._exit(0 if value() == first else 3)
code = os.waitstatus_to_exitcode(os.waitpid(number, 0)[1])
other.join()
""",
    "while a thread compiles": """
other = threading.Thread(target=lambda: dx.evaluate("V_C_wrt_ec", theta=theta, **design))
other.start()
time.sleep(MOMENT)
number = os.fork()
if not number:
    os._exit(0 if value() == first else 3)
code = os.waitstatus_to_exitcode(os.waitpid(number, 0)[1])
other.join()
""",
    "a fork in a fork": """
number = os.fork()
if not number:
    again = value() == first
    inner = os.fork()
    if not inner:
        os._exit(0 if value() == first else 3)
    os._exit(os.waitstatus_to_exitcode(os.waitpid(inner, 0)[1]) if again else 3)
code = os.waitstatus_to_exitcode(os.waitpid(number, 0)[1])
""",
}


def run(program: str, seconds: float, **environment: str) -> tuple[int | None, str, str]:
    """A program in a process of its own: exit code, None where it had to be killed, and what it printed."""
    own = {**os.environ, **environment}
    process = subprocess.Popen(
        [sys.executable, "-c", program], env=own, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    try:
        out, error = process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return None, "", ""
    return process.returncode, out, error


def fork_after_threads(folder: Path, random: Random) -> Verdict:
    way = random.choice(list(FORKS))
    program = FORKS[way].replace("MOMENT", f"{random.uniform(0.0, 1.0)}")
    code, _, error = run(f"{START}\nfirst = value()\n{program}\nsys.exit(code)", 60.0)
    if code is None:
        return Verdict(HUNG, way)
    return GOOD if code == 0 else Verdict(WRONG if code == 3 else CRASHED, f"{way}: {code} {error[-300:]}")


WORKS = {
    "compile": 'dx.evaluate(["Y_wrt_ec", "V_C_wrt_BC"], theta=theta, **design)',
    "grid": 'dx.grid("a_C", theta=theta[::10], ec=np.linspace(0, 0.1, 2000), AB=0.125, BC=0.35, omega0=1.0, '
    'reduce={"theta": "max"})',
    "peaks": 'dx.peak("a_C", ec=np.linspace(0, 0.2, 200_000), AB=0.125, BC=0.35, omega0=1.0)',
    "simulate": "dx.simulate(torque=lambda t, theta, omega: 1.0 - 0.01 * omega, t_end=500.0, I_crank=0.01, "
    "m_slider=1.0, AB=0.125, BC=0.35, ec=0.01)",
    "tables": "dx.simulate(torque=dx.over_theta([0.0, 2.0, 4.0], [1.0, 2.0, 1.0]), t_end=2_000.0, "
    "I_crank=0.01, m_slider=1.0, AB=0.125, BC=0.35, ec=np.linspace(0.0, 0.1, 20_000))",
    "panels": "dx.simulate(torque=lambda t, theta, omega: 1.0 - 0.01 * omega, t_end=50.0, I_crank=0.01, "
    "m_slider=1.0, AB=0.125, BC=0.35, ec=np.linspace(0.0, 0.1, 20_000))",
    "sensitivities": 'dx.simulate(torque=1.0, wrt=["ec", "torque"], t_end=100.0, I_crank=0.01, '
    "m_slider=1.0, AB=0.125, BC=0.35, ec=np.linspace(0.0, 0.1, 20_000))",
    "peaks under a load": 'dx.peak("T_in", ec=np.linspace(0, 0.2, 200_000), AB=0.125, BC=0.35, omega0=1.0, '
    "F_Y=dx.over_theta([0.0, 2.0, 4.0], [1.0, 2.0, 1.0]))",
    "first imports": 'dx.grid("a_C", theta=[0.0, 1.0], ec="1 mm", AB=0.125, BC=0.35, omega0=1.0)',
}
# A job in the background of a shell is started with SIGINT ignored, and so is what it starts.
INTERRUPTED = """
signal.signal(signal.SIGINT, signal.default_int_handler)
print("ready", flush=True)
begun = True
try:
    {work}
    print("done", flush=True)
except KeyboardInterrupt:
    print("stopped", flush=True)
assert abs(value() - first) == 0.0
assert dx.grid("Y", theta=[0.0], ec="1 mm", AB=1.0, BC=2.0, omega0=1.0)["Y"].size == 1
print("usable", flush=True)
"""


def interrupted(folder: Path, random: Random) -> Verdict:
    """SIGINT at some moment: the call stops within a second, and the next one is right."""
    name = random.choice(list(WORKS))
    program = f"{START}\nfirst = value()\n{INTERRUPTED.format(work=WORKS[name])}"
    process = subprocess.Popen(
        [sys.executable, "-c", program], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    assert process.stdout is not None
    process.stdout.readline()
    time.sleep(random.uniform(0.0, 1.5))
    sent = spent(process.pid)
    process.send_signal(signal.SIGINT)
    message = process.stdout.readline()
    more = spent(process.pid) - sent
    try:
        out, error = process.communicate(timeout=120.0)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return Verdict(HUNG, f"{name}: {message}")
    stopped = "stopped" in message
    if not stopped and "done" not in message:
        return Verdict(CRASHED, f"{name}: {error[-300:]}")
    if stopped and "usable" not in out:  # one that came after the end is for the lines behind it
        return Verdict(WRONG, f"{name}: the next call: {error[-300:]}")
    return (
        GOOD
        if more < LATE
        else Verdict(HUNG, f"{name}: {message.strip()} after {more:.1f} s of processor time")
    )


LATE = 5.0  # seconds of processor time after an interrupt: one, on each of some threads


def spent(number: int) -> float:
    """Seconds of processor time of another process, which no load changes; else those of the clock."""
    try:
        return time.clock_gettime(~number << 3 | 2)  # Linux: see clock_getcpuclockid
    except (AttributeError, OSError):
        return time.monotonic()


TRIALS = [
    Trial("fork after a threaded call", fork_after_threads, 1, 30),
    Trial("SIGINT at any moment, then the next call", interrupted, 0, 30),
]
