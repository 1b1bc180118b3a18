"""The page in a real browser: what it says, its controls, how it looks."""

import math

import pytest

import desaxe as dx
from desaxe.mechanism.inputs import INPUTS
from desaxe.mechanism.read import in_si
from tests.scenes.explorer.page import MINUS, design, reading, settle, verdict


def test_it_says_what_it_shows(standing):
    page = standing
    assert verdict(page)[0] == "Turns fully"
    assert "225 mm" in page.inner_text("#margin-words")
    value = dx.evaluate("a_C", theta=math.pi / 3, **design(page))
    assert reading(page, "a_C") == [pytest.approx(value, rel=1e-7)]
    titles = [page.locator(f"#plot-{k} .ytitle").text_content().replace("\u200b", "") for k in (0, 1)]
    assert titles == ["aC [m/s²]", "∂aC/∂ec [1/s²]"]


def test_a_slider_by_keyboard_and_typed_numbers(visit, one_design):
    page = visit(one_design)
    page.focus("#slide-ec")
    before = reading(page, "a_C")
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    settle(page)
    step = float(page.get_attribute("#slide-ec", "step")) / 1000
    assert design(page)["ec"] == pytest.approx(3 * step, rel=1e-12)
    assert float(page.input_value("#number-ec")) == pytest.approx(3000 * step)
    value = dx.evaluate("a_C", theta=math.pi / 3, **design(page))
    assert reading(page, "a_C") == [pytest.approx(value, rel=1e-7)] != before
    # a typed number is the double that was meant
    page.fill("#number-AB", "62.3")
    page.fill("#number-omega0", "3000")
    page.fill("#number-alpha", "-7.5")
    settle(page)
    result = design(page)
    assert (result["AB"], result["alpha"]) == (0.0623, -7.5)
    assert result["omega0"] == pytest.approx(100 * math.pi, rel=1e-15)


@pytest.mark.thorough
def test_a_slider_by_mouse(visit, one_design):
    page = visit(one_design)
    box = page.locator("#slide-BC").bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] * 0.9, box["y"] + box["height"] / 2, steps=5)
    page.mouse.up()
    settle(page)
    assert 0.6 < design(page)["BC"] < 0.66


def test_a_bad_number_is_refused_in_words(standing):
    page = standing
    page.fill("#number-BC", "-3")
    settle(page)
    assert design(page)["BC"] == 0.35
    assert page.inner_text("#wrong-BC") == "It must be a finite length > 0."
    assert page.get_attribute("#number-BC", "aria-invalid") == "true"
    page.keyboard.press("Tab")
    assert page.input_value("#number-BC") == "350"
    assert page.inner_text("#wrong-BC") == ""


@pytest.mark.thorough
def test_the_crank_turns_by_keys(visit, one_design):
    page = visit(one_design)
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Shift+ArrowRight")
    assert page.inner_text("#theta-shown") == "71°"
    page.keyboard.press("Space")
    page.wait_for_function("desaxe.state.theta > 1.5")
    page.keyboard.press("Space")
    stopped = page.evaluate("desaxe.state.theta")
    page.wait_for_timeout(100)
    assert page.evaluate("desaxe.state.theta") == stopped


@pytest.mark.thorough
def test_everything_can_be_reached_by_tab(visit, one_design):
    page = visit(one_design)
    reached = set()
    for _ in range(40):
        page.keyboard.press("Tab")
        reached.add(page.evaluate("document.activeElement.id"))
    inputs = {
        f"{kind}-{name}" for kind in ("slide", "number") for name in ("AB", "BC", "ec", "omega0", "alpha")
    }
    buttons = {"play", "theta", "keep", "save-scene", "save-csv", "save-png", "theme"}
    assert inputs | buttons | {"quantity-0", "by-0", "quantity-1", "by-1"} <= reached


@pytest.mark.thorough
def test_every_control_has_a_name(visit, several_designs):
    nameless = """[...document.querySelectorAll('main input, main select, main button')]
        .filter((e) => !(e.labels?.length || e.getAttribute('aria-label') || e.textContent.trim()))
        .map((e) => e.outerHTML)"""
    assert visit(several_designs).evaluate(nameless) == []


@pytest.mark.thorough
def test_typing_what_is_there_changes_nothing(visit, several_designs, folder):
    page = visit(several_designs)
    page.fill("#number-omega0", "1500")
    settle(page)
    assert design(page)["omega0"] == design(page, 1)["omega0"] == 1500 * math.pi / 30
    assert page.inner_text("#export-note") == ""
    odd = visit(dx.explore(path=folder / "odd.html", ec=[0.0, 0.1], AB=0.1 + 0.2, BC=1.0, omega0=157.08))
    for name in ("AB", "omega0"):
        odd.fill(f"#number-{name}", odd.input_value(f"#number-{name}"))
    settle(odd)
    assert (design(odd)["AB"], design(odd)["omega0"]) == (0.1 + 0.2, 157.08)


@pytest.mark.parametrize(
    ("unit", "text", "si"),
    [
        ("m", "62.3", "62.3 mm"), ("m", "-1e2", "-100 mm"), ("rad/s", "1450.5", "1450.5 rpm"),
        ("kg*m^2", "80.6", "80.6 kg mm2"),
    ],
)  # fmt: skip
def test_a_field_means_what_python_means(unit, text, si, standing):
    name = {"m": "ec", "rad/s": "omega0", "kg*m^2": "I_rod"}[unit]
    expected = 80.6e-6 if name == "I_rod" else in_si(INPUTS[name], si)
    assert standing.evaluate("([u, t]) => desaxe.toSI(u, t)", [unit, text]) == expected


@pytest.mark.thorough
def test_a_slider_comes_back_from_a_large_entry(visit, one_design):
    page = visit(one_design)
    before = page.get_attribute("#slide-ec", "max")
    page.fill("#number-ec", "5000")
    settle(page)
    assert float(page.get_attribute("#slide-ec", "max")) >= 5000
    page.fill("#number-ec", "10")
    settle(page)
    assert page.get_attribute("#slide-ec", "max") == before


@pytest.mark.thorough
def test_what_changes_is_said(visit, one_design):
    page = visit(one_design)
    page.keyboard.press("ArrowRight")
    page.wait_for_function("document.getElementById('said').textContent.startsWith('At 61°')")
    value = dx.evaluate("a_C", theta=page.evaluate("desaxe.state.theta"), **design(page))
    assert f"a_C = {f'{value:.5g}'.replace('-', MINUS)} m/s²" in page.text_content("#said")
    page.fill("#number-ec", "900")
    page.wait_for_function("document.getElementById('said').textContent.includes('a_C = no value')")


@pytest.mark.parametrize(
    "width", [390, *(pytest.param(width, marks=pytest.mark.thorough) for width in (360, 768, 1024))]
)
def test_it_fits_the_screen(width, visit, several_designs):
    page = visit(several_designs, width, 844, has_touch=True, is_mobile=width < 700)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    outside = f"""[...document.querySelectorAll('main section, main button, main input, main select, .plot')]
        .filter((e) => e.getClientRects().length && e.getBoundingClientRect().right > {width} + 1)
        .map((e) => e.id)"""
    assert page.evaluate(outside) == []
    small = """[...document.querySelectorAll('main button[id], main select')]
        .filter((e) => e.getBoundingClientRect().height < 30).map((e) => e.id)"""
    assert page.evaluate(small) == []


@pytest.mark.thorough
def test_light_and_dark(visit, one_design):
    page = visit(one_design, color_scheme="dark")
    colour = "getComputedStyle(document.body).backgroundColor"
    dark = page.evaluate(colour)
    page.click("#theme")
    assert page.evaluate(colour) != dark
    assert page.inner_text("#theme") == "Dark"
