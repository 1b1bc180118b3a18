"""Trial of memory: thousands of mixed calls, of which the memory of a process must not tell the number."""

from pathlib import Path
from random import Random

from tests.reliability.processes import run
from tests.reliability.rig import CRASHED, GOOD, HUNG, WRONG, Trial, Verdict

MORE = 12.0  # MB that the last three quarters of the calls may add
PROGRAM = """
import gc, random, sys, warnings
from pathlib import Path
import numpy as np
import desaxe as dx
warnings.simplefilter("ignore")
random.seed({seed})
PAGE = 4096 / 1e6
names = [name for name in dx.quantities() if name not in ("status", "M_eff_wrt_theta")][:40]
kinematic = ["Y", "V_C", "a_C", "omega_BC", "alpha_BC", "a_C_wrt_ec", "V_C_wrt_BC"]
pairs = [["V_C", "a_C"], ["Y", "status"], ["a_C", "a_C_wrt_ec"]]
masses = dict(m_slider=1.0, m_rod=0.5, I_rod=0.01)
theta = np.linspace(0.0, 6.0, 50)
few = theta[:7]
prepared = dx.function("a_C", ec=0.01, AB=0.125, BC=0.35, omega0=100.0)

def design():
    return dict(ec=random.uniform(0, 0.1), AB=random.uniform(0.05, 0.12), BC=random.uniform(0.3, 0.4))

def refused():
    try:
        dx.evaluate("V_C", theta=random.choice(["x", 1j, None]), omega0=1.0, **design())
    except (ValueError, TypeError):
        pass

calls = [
    lambda: dx.evaluate(random.choice(kinematic), theta=random.random(), omega0=random.random(), **design()),
    lambda: dx.evaluate(random.choice(names), theta=1.0, omega0=3.0, **design(), **masses),
    lambda: dx.evaluate(random.choice(kinematic), theta=few, omega=1.0, **design()),
    lambda: dx.evaluate(random.choice(pairs), theta=theta, omega0="100 rpm", **design()),
    lambda: dx.peak(random.choice(["a_C", "V_C"]), omega0=random.random() + 1.0, **design()),
    lambda: dx.inverse(Y=0.3, **design()),
    lambda: dx.events(**design()),
    lambda: dx.feasibility(**design()),
    lambda: dx.grid("a_C", theta=theta[:5], omega0=[1.0, random.random()], **design()),
    lambda: prepared(random.random()),
    lambda: dx.Machine(omega0=1.0, **design()).evaluate("a_C", theta=1.0),
    refused,
]

def resident():
    gc.collect()
    return int(Path("/proc/self/statm").read_text().split()[1]) * PAGE

# A search or request is compiled when it has been asked for often enough: here at once.
for name in ("a_C", "V_C"):
    dx.peak(name, ec=np.linspace(0.0, 0.1, 20_000), AB=0.1, BC=0.35, omega0=1.0)
for k in range({count}):
    if k == {count} // 4:
        before = resident()
    random.choice(calls)()
print(before, resident())
"""


COUNT = 20_000


def mixed_calls(folder: Path, random: Random) -> Verdict:
    """Memory after a quarter of the calls, and after all of them."""
    program = PROGRAM.format(seed=random.randrange(10**6), count=COUNT)
    code, out, error = run(program, 900.0)
    if code is None:
        return Verdict(HUNG)
    if code:
        return Verdict(CRASHED, f"{code} {error[-300:]}")
    before, after = map(float, out.split())
    return GOOD if after - before < MORE else Verdict(WRONG, f"{before:.0f} MB, then {after:.0f} MB")


TRIALS = [Trial("20,000 mixed calls: the memory stays flat after the first 5,000", mixed_calls, 0, 1)]
