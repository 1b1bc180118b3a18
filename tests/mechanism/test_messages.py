"""Messages know their quantities: errors and answers of a machine or scene are in its units."""

import ast
import pickle
import re
import threading
import warnings
from pathlib import Path

import pytest

import desaxe as dx
from desaxe.mechanism import public, slips
from desaxe.mechanism.messages import amount, errors_in, listed, named
from desaxe.mechanism.quantity_units import UnitSystem

UNITS = UnitSystem.read("mm, deg, rpm, kN")
PRESS = dx.Machine(units="mm, deg, rpm, kN", ec=10, AB=50, BC=200, omega0=300, m_slider=4, I_crank=0.1)
PEAK = {"minimize": ("absmax", "a_C")}


def test_numbers_pairs_and_what_is_no_number():
    assert [amount("ec", 0.03), amount("ec", 0.03, "g", says_unit=True)] == ["0.03", "0.03 m"]
    texts = {
        "ec = 30 mm": named("ec", 0.03),
        "(30, -10) mm": amount("AB", (0.03, -0.01), "g"),
        "300 rpm": amount("omega_mean", 31.41592653589793, ".6g"),
        "2 N m": amount("T_in", 2.0, "g", says_unit=True),
        "'12 mm'": amount("ec", "12 mm"),
        "AB = 30 mm or -10 mm; too": listed([named("AB", 0.03), amount("AB", -0.01)], " or ") + "; too",
        "over: 30 mm": "over" + ("BC: " + amount("AB", 0.03)).removeprefix("BC"),
    }
    assert [message.in_units(UNITS) for message in texts.values()] == [*texts]
    copied = pickle.loads(pickle.dumps(named("ec", 0.03)))
    assert (copied, copied.in_units(UNITS)) == ("ec = 0.03", "ec = 30 mm")


def test_an_error_is_in_the_units_of_the_innermost_border():
    with pytest.raises(ValueError, match="AB = 30 mm"), errors_in(UnitSystem.read("m")), errors_in(UNITS):
        raise ValueError(named("AB", 0.03))


def test_no_message_is_put_into_an_f_string():
    """Of one in an f-string the text in SI units alone would be left."""
    makers, wrong = {"amount", "named", "listed", "message_of", "time_of", "angle_of"}, []
    texts = ((path, path.read_text(encoding="utf-8")) for path in Path(dx.__file__).parent.rglob("*.py"))
    for path, text in texts:
        used = any(f"{maker}(" in text for maker in makers)
        for node in ast.walk(ast.parse(text)) if used else ():
            inside = ast.walk(node) if isinstance(node, ast.JoinedStr) else ()
            calls = [part.func for part in inside if isinstance(part, ast.Call)]
            wrong += [f"{path}:{f.lineno}" for f in calls if isinstance(f, ast.Name) and f.id in makers]
    assert not wrong


ERRORS = {
    "over: ec = (30, 0) mm": lambda: PRESS.optimize(**PEAK, over={"ec": (30, 0)}),
    "over: AB = (-30, 10) mm: expected two finite bounds (AB = -30 mm": lambda: PRESS.optimize(
        **PEAK, over={"AB": (-30, 10)}
    ),
    "keep: stroke = (120, 100) mm": lambda: PRESS.optimize(
        **PEAK, over={"AB": (30, 60)}, keep={"stroke": (120, 100)}
    ),
    "theta0 = -90 deg: it cannot be assembled there; with ec = 10 mm, AB = 195 mm, BC = 150 mm": (
        lambda: PRESS.replace(AB=195, BC=150).simulate(torque=1, t_end=0.1, theta0=-90)
    ),
    "theta = (90, 20) deg": lambda: PRESS.peak("a_C", theta=(90, 20)),
    "AB = -3 mm: it must be": lambda: PRESS.evaluate("a_C", theta=30, AB=-3),
    "the crank cannot turn fully, margin = -10 mm": lambda: PRESS.harmonics("a_C", AB=200),
    "at omega =": lambda: PRESS.steady(torque=lambda omega: float("nan")),
    "but 10 mm follows 20 mm": lambda: PRESS.over_Y([0, 20, 10], [1, 2, 3]),
    "the speeds must ascend, but 100 rpm follows 300 rpm": lambda: PRESS.over_omega([300, 100], [1, 2]),
    "theta = 5 deg: expected a range": lambda: PRESS.peak("a_C", theta=5),
    "theta = 1000000000000 deg: accuracy='extended' reaches |theta| <= 96636764156 deg": (
        lambda: PRESS.evaluate("a_C", theta=1e12, accuracy="extended")
    ),
    "AB: a tolerance of -1 mm": lambda: PRESS.tolerance("Y", theta=30, AB=dx.plus_minus(50, -1)),
    "the angles go over 400 deg, the period is 360 deg": lambda: PRESS.over_theta([0, 90, 400], [1, 2, 3]),
    "the first is -200 mm": lambda: PRESS.grid("a_C", theta=[0, 30], BC=[-200, -300]),
    "AB = 1e+40 mm": lambda: PRESS.fit({"theta": [0, 30], "Y": [250, 240]}, over={"AB": 1e40}),
    "F_Y = inf kN: it must be": lambda: PRESS.replace(F_Y=float("inf")),
}


@pytest.mark.parametrize("message", ERRORS)
def test_errors_of_a_machine_are_in_its_units(message):
    with pytest.raises(ValueError, match=re.escape(message)):
        ERRORS[message]()


def test_messages_of_steady_are_in_the_machines_units():
    weak = PRESS.steady(torque=PRESS.kloss(1e-6, 0.15, 1500), F_Y=-1.0, mu=0.1)["message"]
    assert "rad" not in weak
    strong = PRESS.steady(torque=lambda omega: 0.5 * omega)["message"]
    assert "rpm a period still gains" in strong


def test_a_motor_speaks_the_units_of_its_machine():
    assert "synchronous_speed = 1500 rpm" in repr(PRESS.kloss(40, 0.15, 1500))
    assert "synchronous_speed = 157" in repr(dx.kloss(40, 0.15, 157))
    table = dx.Machine(units="kN m, rpm", AB=0.1).over_omega([0, 1500], [1, 0])
    assert repr(table) == "<motor over omega: 2 speeds, linear, 0 kN m to 1 kN m>"


@pytest.mark.thorough
def test_a_report_shows_loads_in_the_machines_units(tmp_path):
    press = PRESS.replace(F_Y=PRESS.over_Y([150, 250], [-1, -2]))
    text = press.report(tmp_path / "press.md", outputs="Y").read_text(encoding="utf-8")
    assert "-2 to -1 kN" in text
    assert "-1000" not in text


def test_a_knot_is_no_force_of_a_machine():
    with pytest.raises(ValueError, match="'kn' is not a known unit; did you mean kN"):
        dx.Machine(units="mm, kn", AB=50)
    assert dx.Machine(units="knot", AB=1).units.units == {"velocity": "knot"}
    assert dx.Machine(units="RPM", AB=1).units.units == {"angular speed": "RPM"}


SLIPS = {
    'breakdown_slip = "15 %"': lambda: dx.kloss(40.0, 15.0, 157.0),
    "breakdown_slip = 1500, where a slip of 1 is standstill": lambda: dx.kloss(40.0, 1500, 0.15),
    'synchronous_speed = "1500 rpm"': lambda: dx.kloss(40.0, 0.15, 1500.0),
    'omega = "1500 rpm"': lambda: dx.over_omega([0.0, 1500.0], [40.0, 0.0]),
    'AB = "50 mm"': lambda: dx.steady(
        torque=dx.kloss(40.0, 0.15, 157.0), ec=10.0, AB=50.0, BC=200.0, I_crank=0.1
    ),
}


@pytest.mark.parametrize("message", SLIPS)
def test_slips_of_motors_are_told(message):
    slips.WARNED.clear()
    public.LOOKS[0] = 1000
    with pytest.warns(dx.UnitWarning, match=message) as warned:
        SLIPS[message]()
    assert [each.filename for each in warned] == [__file__]


def test_lengths_of_chunks_are_no_slips_and_hide_none():
    slips.WARNED.clear()
    public.LOOKS[0] = 1000
    machine = {"ec": 0.0, "AB": 0.125, "BC": 0.35, "omega0": 1.0}
    dx.grid("a_C", theta=[0.0, 1.0], chunks={"theta": 100}, **machine)
    with pytest.warns(dx.UnitWarning, match='write theta = "100 deg"'):
        dx.evaluate("a_C", theta=100, **machine)


def test_proper_motors_are_no_slips():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        motor = PRESS.kloss("40 N m", "15 %", 1500, gear=5)
        dx.kloss(40.0, [0.1, 0.5], 377.0)
        PRESS.steady(torque=motor)


def test_a_load_shows_itself_in_the_units_of_its_machine():
    press = PRESS.over_Y([150, 250], [-1, -2])
    assert repr(press) == "<load over Y: 2 points, linear, -2 to -1 kN>"
    assert press.told() == repr(dx.over_Y([0.15, 0.25], ["-1000 N", "-2000 N"]))
    in_si = dx.over_Y(["150 mm", "250 mm"], ["-1 kN", "-2 kN"])
    assert press.identity == in_si.identity
    assert "0 to 1 kN" in repr(PRESS.over_theta([0, 90], [0, 1], "linear"))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: PRESS.over_Y(1, 2, 3, 4, 5), "over_Y() takes from 1 to 4 positional arguments but 5"),
        (lambda: dx.over_Y.read(1, 2, 3, 4, 5), "over_Y.read() takes from 1 to 4 positional arguments but 5"),
        (lambda: PRESS.kloss(1, 2, 3, 4, 5), "kloss() takes from 3 to 4 positional arguments but 5"),
    ],
)
def test_arguments_of_a_maker_are_counted_without_it(call, message):
    with pytest.raises(TypeError, match=re.escape(message)):
        call()


def test_threads_speak_the_units_of_the_call_that_they_make():
    """A call of desaxe in a user's thread inside a machine's call takes SI units and speaks them."""
    heard = []

    def tell(call):
        with pytest.raises(ValueError, match="AB") as result:
            call()
        heard.append(str(result.value))

    def force(theta):
        calls = [lambda: dx.evaluate("Y", theta=1.0, ec=0.0, AB=-0.05, BC=0.2), lambda: PRESS.replace(AB=-50)]
        threads = [threading.Thread(target=tell, args=(call,)) for call in calls]
        for thread in threads:
            thread.start()
            thread.join()
        return 0.0 * theta

    PRESS.evaluate("T_in", theta=1.0, F_Y=PRESS.over_theta(force))
    assert ("AB = -0.05:" in heard[0], "AB = -50 mm:" in heard[1]) == (True, True), heard
