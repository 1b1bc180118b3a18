"""The page in a real browser: its controls, what it says, what it draws, what it gives away."""

import csv
import io
import math
import re

import pytest

import desaxe as dx
from desaxe.mechanism.units import in_si

MINUS, NONE = "\u2212", "\u2013"
RAISED = str.maketrans("\u207b\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079", "-0123456789")
FINITE = "(k) => desaxe.curve(desaxe.state.shown[0], desaxe.state.designs[k]).value.map((v) => v !== null)"


def design(page, k=0):
    return page.evaluate(f"desaxe.state.designs[{k}]")


def verdict(page):
    return page.inner_text("#verdict-kind"), page.inner_text("#verdict-words")


def drawn_lines(page, chart=0):
    """The number of pieces of each drawn curve."""
    traces = f"[...document.querySelectorAll('#plot-{chart} .scatterlayer .trace')]"
    return page.evaluate(
        f"{traces}.map((trace) => trace.querySelectorAll('.js-line').length).filter(Boolean)"
    )


def settle(page):
    """Until what was asked for is drawn."""
    page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


def reading(page, name):
    """The values of a row under the cursor, as numbers."""
    cells = page.locator(f"#readings tr[data-name='{name}'] td:not(.unit)").all_inner_texts()
    return [number(text) if text != NONE else None for text in cells]


def number(text):
    """A number as the page prints it, such as -7.7 times a power of ten."""
    mantissa, _, power = text.replace(MINUS, "-").partition(" \u00d7 10")
    return float(mantissa) * 10.0 ** int(power.translate(RAISED) or 0)


def test_it_says_what_it_shows(visit, one_design):
    page = visit(one_design)
    assert verdict(page)[0] == "Turns fully"
    assert "225 mm" in page.inner_text("#margin-words")
    value = dx.evaluate("a_C", theta=math.pi / 3, **design(page))
    assert reading(page, "a_C") == [pytest.approx(value, rel=1e-7)]
    titles = [page.locator(f"#plot-{k} .ytitle").text_content().replace("\u200b", "") for k in (0, 1)]
    assert titles == ["aC [m/s²]", "∂aC/∂ec [1/s²]"]


def test_a_slider_by_keyboard(visit, one_design):
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


def test_a_typed_number_is_the_double_that_was_meant(visit, one_design):
    page = visit(one_design)
    page.fill("#number-AB", "62.3")
    page.fill("#number-omega0", "3000")
    page.fill("#number-alpha", "-7.5")
    settle(page)
    found = design(page)
    assert (found["AB"], found["alpha"]) == (0.0623, -7.5)
    assert found["omega0"] == pytest.approx(100 * math.pi, rel=1e-15)


def test_a_bad_number_is_refused_in_words(visit, one_design):
    page = visit(one_design)
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


def test_an_infeasible_design(visit, one_design):
    page = visit(one_design)
    page.fill("#number-ec", "240")
    settle(page)
    kind, words = verdict(page)
    assert kind == "Cannot turn fully"
    assert "from 61.64° to 118.36°" in words
    assert drawn_lines(page) == [2]
    page.evaluate("document.activeElement.blur()")
    for _ in range(3):
        page.keyboard.press("Shift+ArrowRight")
    assert page.inner_text("#theta-shown") == "90°"
    assert reading(page, "a_C") == [None]
    assert "the crank pin is 365 mm from the slider axis" in page.inner_text("#readings .why")
    assert "does not reach" in page.inner_text("#mechanism")


@pytest.mark.thorough
def test_no_curve_where_nothing_can_be_assembled(visit, one_design):
    page = visit(one_design)
    page.fill("#number-ec", "900")
    settle(page)
    assert verdict(page)[0] == "Cannot be assembled"
    assert not any(page.evaluate(FINITE, 0))
    assert drawn_lines(page) == []
    assert page.inner_text("#note-0") == "No curve: this has no value at any of these angles."


@pytest.mark.thorough
def test_a_gap_narrower_than_a_sample_is_no_line(visit, one_design):
    """A hundredth of a degree, in which no sample of the even ones lies but the quarter itself."""
    page = visit(one_design)
    page.fill("#number-ec", "225.000001")
    settle(page)
    assert verdict(page)[0] == "Cannot turn fully"
    assert drawn_lines(page, 1) == [2]


@pytest.mark.parametrize("ec", [0.225, 0.2250000001, 0.23, 0.3, -0.25, -0.475])
def test_a_curve_is_where_evaluate_has_a_value(ec, standing):
    lengths = {**design(standing), "ec": ec}
    curve = standing.evaluate("(d) => desaxe.curve('V_C', d)", lengths)
    told = [
        (value is not None, math.isfinite(dx.evaluate("V_C", theta=theta, **lengths)))
        for theta, value in zip(curve["theta"], curve["value"], strict=True)
        if not next_to_a_limit(theta, lengths)
    ]
    assert len(told) >= len(curve["theta"]) - 4
    assert [ours for ours, _ in told] == [python for _, python in told]
    assert curve["theta"] == sorted(curve["theta"])


def next_to_a_limit(theta, lengths):
    """True within a few doubles of a limit angle, where the page, unlike Python, may be undecided."""
    away = 4 * math.ulp(theta)
    near = (dx.evaluate("status", theta=angle, **lengths) for angle in (theta - away, theta + away))
    return len(set(near)) > 1


@pytest.mark.thorough
def test_a_crank_that_stalls(visit, one_design):
    page = visit(one_design)
    page.fill("#number-alpha", "-4000")
    settle(page)
    omega0 = design(page)["omega0"]
    assert f"stalls at {math.degrees(omega0**2 / 8000):.2f}°" in verdict(page)[1]
    curve = page.evaluate("desaxe.curve('V_C', desaxe.state.designs[0])")
    last = max(t for t, v in zip(curve["theta"], curve["value"], strict=True) if v is not None)
    assert last == pytest.approx(omega0**2 / 8000, rel=1e-9)


def test_several_designs_are_compared(visit, several_designs):
    page = visit(several_designs)
    labels = page.locator("#designs .label").all_inner_texts()
    assert [label.partition(" (")[0] for label in labels] == ["ec = 0 mm", "ec = 100 mm", "ec = 230 mm"]
    titles = [mark.get_attribute("title") for mark in page.locator("#designs .badge").all()]
    assert titles == ["Turns fully", "Turns fully", "Cannot turn fully"]
    assert sorted(drawn_lines(page)) == [1, 1, 2]
    wanted = [dx.evaluate("V_C", theta=math.pi / 3, **design(page, k)) for k in range(3)]
    assert reading(page, "V_C") == [pytest.approx(v, rel=1e-7) for v in wanted]
    page.click("[data-take='2']")
    assert verdict(page)[0] == "Cannot turn fully"
    page.click("[data-drop='1']")
    page.click("#keep")
    assert len(reading(page, "V_C")) == 3
    assert page.inner_text("#export-note") == ""
    page.fill("#number-AB", "110")
    settle(page)
    assert "differ in more than one input" in page.inner_text("#export-note")


@pytest.mark.thorough
def test_a_few_huge_values_do_not_hide_the_others(visit, one_design):
    """Next to a limit angle, and at the narrow peak of a design next to its change point."""
    page = visit(one_design)
    height = "document.getElementById('plot-1').layout.yaxis.range"
    for ec, note in (("240", "next to a limit angle"), ("224.9999999", "A narrow peak of")):
        page.fill("#number-ec", ec)
        settle(page)
        curve = page.evaluate("desaxe.curve('a_C_wrt_ec', desaxe.state.designs[0]).value")
        low, high = page.evaluate(height)
        assert max(abs(v) for v in curve if v is not None) > 100 * (high - low)
        assert note in page.inner_text("#note-1")
        drawn = page.evaluate("document.querySelector('#plot-1 .js-line').getAttribute('d')")
        assert max(abs(float(v)) for v in re.findall(r"-?[\d.]+(?:e[-+]?\d+)?", drawn)) < 1e7


def figure(page, name):
    """A row of the figures of each design."""
    return page.locator(f"#figures tr[data-figure='{name}'] td").all_inner_texts()


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
    wanted = 80.6e-6 if name == "I_rod" else in_si(name, si)
    assert standing.evaluate("([u, t]) => desaxe.toSI(u, t)", [unit, text]) == wanted


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
def test_turning_is_that_of_feasibility(visit, one_design):
    """0.35 - 0.125 - 0.225 is -2.8e-17 in doubles: so near its change point, yet it cannot turn fully."""
    page = visit(one_design)
    page.fill("#number-ec", "225")
    settle(page)
    assert not dx.feasibility(ec=0.225, AB=0.125, BC=0.35)["can_turn"]
    assert figure(page, "turns") == ["no"]
    assert "it cannot turn fully" in verdict(page)[1]


@pytest.mark.parametrize("branch", [1, -1])
def test_the_figures_of_a_design(branch, visit, folder):
    inputs = {"AB": 0.125, "BC": 0.35, "omega0": 157.0, "branch": branch}
    page = visit(dx.explore(path=folder / "figures.html", ec=[0.0, 0.1, -0.2], **inputs))
    for k, ec in enumerate((0.0, 0.1, -0.2)):
        found = page.evaluate(f"desaxe.turnOf(desaxe.state.designs[{k}])")
        wanted = dx.events(ec=ec, AB=0.125, BC=0.35, branch=branch)
        assert found["stroke"] == pytest.approx(wanted["stroke"], rel=1e-14)
        assert found["ratio"] == pytest.approx(wanted["time_ratio"], rel=1e-13)
        assert found["pressure"] == pytest.approx(wanted["max_pressure_angle"], rel=1e-13)
        for which in ("outer", "inner"):
            apart = (found[which] - wanted[f"theta_{which}"] + math.pi) % (2 * math.pi) - math.pi
            assert abs(apart) < 1e-12
        top = "((d) => desaxe.peakOf('a_C', d, desaxe.curve('a_C', d)))"
        peak = page.evaluate(f"{top}(desaxe.state.designs[{k}])")
        exact = dx.peak("a_C", ec=ec, **inputs)
        assert abs(peak["value"]) == pytest.approx(exact["value"], rel=1e-12)
    assert figure(page, "stroke")[1] == f"{1e3 * dx.events(ec=0.1, AB=0.125, BC=0.35)['stroke']:.3f} mm"


@pytest.mark.thorough
def test_a_peak_without_bound_is_told(visit, several_designs):
    page = visit(several_designs)
    page.click("[data-take='2']")
    assert figure(page, "stroke")[0] == NONE
    assert figure(page, "peak-a_C")[0].split("\n") == ["no bound", "next to a limit angle"]


@pytest.mark.thorough
def test_the_slider_axis_is_upright(visit, one_design):
    """As in the sketch of README: Y up, X to the right, the slider axis at X = -ec."""
    page = visit(one_design)
    page.fill("#number-ec", "100")
    settle(page)
    place = """(name) => { const e = [...document.querySelectorAll('#mechanism text')]
        .find((t) => t.textContent === name); return [+e.getAttribute('x'), +e.getAttribute('y')]; }"""
    a, b, c, x, y = (page.evaluate(place, name) for name in "ABCXY")
    assert c[1] < b[1] < a[1]  # upwards
    assert c[0] < a[0] < b[0] < x[0]
    assert y[1] < c[1]


@pytest.mark.thorough
def test_tables_and_files_in_other_units(visit, several_designs):
    page = visit(several_designs)
    page.select_option("#units", "mm")
    theta, inputs = page.evaluate("desaxe.state.theta"), design(page)
    scale = {"Y": 1e3, "a_C": 1e3, "phi": 180 / math.pi, "omega_BC": 30 / math.pi, "a_C_wrt_ec": 1.0}
    for name, times in scale.items():
        wanted = times * dx.evaluate(name, theta=theta, **inputs)
        assert reading(page, name)[0] == pytest.approx(wanted, rel=1e-7)
    units = page.locator("#readings td.unit").all_inner_texts()
    assert units == ["mm/s²", "1/s²", "mm", "mm/s", "°", "rpm", "rad/s²"]
    rows = list(csv.reader(io.StringIO(page.evaluate("desaxe.valuesText()"))))
    assert rows[0][:3] == ["theta [deg]", "a_C [mm/s^2] (ec = 0 mm)", "a_C_wrt_ec [1/s^2] (ec = 0 mm)"]
    assert float(rows[-1][0]) == pytest.approx(360.0)
    assert float(rows[1][1]) == pytest.approx(1e3 * dx.evaluate("a_C", theta=0.0, **inputs), rel=1e-12)
    page.select_option("#units", "all")
    assert float(page.input_value("#number-AB")) == 0.125
    assert "m" in page.inner_text("#field-AB .unit")


@pytest.mark.thorough
def test_a_machine_brings_its_units(visit, folder):
    """Fields, values, tables and files in inches and standard gravities; the scene is the same machine."""
    units = {"length": "in", "angle": "deg", "a_C": "standard_gravity"}
    press = dx.Machine(ec=1, AB=2, BC=7.3, omega0="300 rpm", m_slider=3, F_Y=-50, units=units)
    page = visit(press.explore(path=folder / "inches.html"))
    page.select_option("#quantity-0", "a_C")
    page.select_option("#quantity-1", "a_C")
    page.select_option("#by-1", "a_C_wrt_ec")
    theta, inputs = page.evaluate("desaxe.state.theta"), design(page)
    assert inputs["BC"] == press["BC"] == 7.3 * 0.0254
    assert page.input_value("#number-BC") == "7.3"
    assert "4.3 in" in page.inner_text("#margin-words")
    assert page.inner_text("#loads-words") == f"m_slider = 3 kg, F_Y = {MINUS}50 N"
    si = {name: dx.evaluate(name, theta=theta, **inputs) for name in ("a_C", "a_C_wrt_ec", "Y", "omega_BC")}
    scale = {"a_C": 1 / 9.80665, "a_C_wrt_ec": 0.0254 / 9.80665, "Y": 1 / 0.0254, "omega_BC": 1.0}
    for name, times in scale.items():
        assert reading(page, name)[0] == pytest.approx(times * si[name], rel=1e-7)
    heads = next(csv.reader(io.StringIO(page.evaluate("desaxe.valuesText()"))))
    assert heads[1:3] == [f"{n} (this design)" for n in (
        "a_C [standard_gravity]", "a_C_wrt_ec [standard_gravity/in]"
    )]  # fmt: skip
    saved = folder / "inches.toml"
    saved.write_text(page.evaluate("desaxe.sceneText()"), encoding="utf-8")
    assert dx.Machine.read(saved) == press
    assert dx.scene(saved).run().dataset.a_C.units == "standard_gravity"


@pytest.mark.thorough
def test_loads_can_be_set(visit, folder):
    page = visit(
        dx.explore(path=folder / "loaded.html", ec=0.01, AB=0.04, BC=0.064, omega0=100.0, m_slider=1.0)
    )
    page.click("#more summary")
    page.fill("#number-F_Y", "-50")
    page.fill("#number-mu", "0.1")
    settle(page)
    given = design(page)
    assert (given["F_Y"], given["mu"], given["m_rod"]) == (-50.0, 0.1, 0.0)
    theta = page.evaluate("desaxe.state.theta")
    for name in ("T_in", "F_A_X", "M_shaking"):
        found = page.evaluate("([n, d, t]) => desaxe.valueAt(n, d, t)", [name, given, theta])
        assert found == pytest.approx(dx.evaluate(name, theta=theta, **given), rel=1e-12)


@pytest.mark.thorough
def test_what_changes_is_said(visit, one_design):
    page = visit(one_design)
    page.keyboard.press("ArrowRight")
    page.wait_for_function("document.getElementById('said').textContent.startsWith('At 61°')")
    value = dx.evaluate("a_C", theta=page.evaluate("desaxe.state.theta"), **design(page))
    assert f"a_C = {f'{value:.5g}'.replace('-', MINUS)} m/s²" in page.text_content("#said")
    page.fill("#number-ec", "900")
    page.wait_for_function("document.getElementById('said').textContent.includes('a_C = no value')")


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_what_is_read_stands_out(scheme, visit, one_design):
    """WCAG 2: text 4.5 to 1 against what it stands on, curves and the edges of controls 3 to 1."""
    page = visit(one_design, color_scheme=scheme)
    style = "(n) => getComputedStyle(document.documentElement).getPropertyValue(`--${n}`).trim()"
    colour = {
        n: page.evaluate(style, n) for n in ("page", "panel", "ink", "soft", "good", "warn", "bad", "edge")
    }
    curves = [page.evaluate(style, f"curve-{k}") for k in range(1, 7)]
    text = [(name, ground) for name in ("ink", "soft", "good", "warn", "bad") for ground in ("page", "panel")]
    assert [pair for pair in text if contrast(*(colour[n] for n in pair)) < 4.5] == []
    assert [c for c in (*curves, colour["edge"]) if contrast(c, colour["panel"]) < 3] == []


def contrast(one, other):
    """The contrast ratio of two colours such as #1b2330."""
    lights = []
    for colour in (one, other):
        parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
        linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
        lights.append(0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2])
    return (max(lights) + 0.05) / (min(lights) + 0.05)


@pytest.mark.thorough
def test_a_finger_reads_a_curve_and_moves_the_page(visit, several_designs):
    page = visit(several_designs, 390, 844, has_touch=True, is_mobile=True)
    page.locator("#plot-0").scroll_into_view_if_needed()
    assert page.locator(".modebar-btn").count() == 0  # they would lie on the legend
    box = page.locator("#plot-0 .bglayer").bounding_box()
    page.touchscreen.tap(box["x"] + box["width"] * 0.75, box["y"] + box["height"] / 2)
    page.wait_for_function("desaxe.state.theta > 4.5 && desaxe.state.theta < 4.9")
    before = page.evaluate("scrollY")
    swipe_up(page, box["x"] + box["width"] / 2, box["y"] + box["height"] / 2, 100)
    page.wait_for_function(f"scrollY > {before} + 40")


def swipe_up(page, x, y, length):
    finger = page.context.new_cdp_session(page)
    for k in range(11):
        at = {"x": x, "y": y - length * k / 10}
        finger.send(
            "Input.dispatchTouchEvent", {"type": "touchMove" if k else "touchStart", "touchPoints": [at]}
        )
    finger.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})


@pytest.mark.thorough
def test_any_quantity_and_sensitivity(visit, one_design):
    page = visit(one_design)
    for option in page.locator("#quantity-0 option").all():
        page.select_option("#quantity-0", option.get_attribute("value"))
        settle(page)
        assert drawn_lines(page), option.get_attribute("value")
    page.select_option("#quantity-0", "omega_BC")
    page.select_option("#by-0", "omega_BC_wrt_AB")
    settle(page)
    value = dx.evaluate("omega_BC_wrt_AB", theta=math.pi / 3, **design(page))
    assert reading(page, "omega_BC_wrt_AB") == [pytest.approx(value, rel=1e-7)]


@pytest.mark.thorough
def test_values_follow_the_pointer(visit, one_design):
    page = visit(one_design)
    box = page.locator("#plot-0 .nsewdrag").bounding_box()
    page.mouse.move(box["x"] + box["width"] * 0.75, box["y"] + box["height"] / 2)
    page.wait_for_function("desaxe.state.theta > 4.6 && desaxe.state.theta < 4.8")
    value = dx.evaluate("a_C", theta=page.evaluate("desaxe.state.theta"), **design(page))
    assert reading(page, "a_C") == [pytest.approx(value, rel=1e-7)]


def saved(page, button):
    with page.expect_download() as waiting:
        page.click(button)
    return waiting.value


@pytest.mark.thorough
def test_the_scene_runs(visit, several_designs, tmp_path):
    page = visit(several_designs)
    download = saved(page, "#save-scene")
    assert download.suggested_filename == "scene.toml"
    download.save_as(tmp_path / "scene.toml")
    scene = dx.scene(tmp_path / "scene.toml")
    assert scene.inputs["ec"] == (0.0, 0.1, 0.23)
    assert scene.outputs == ("a_C", "a_C_wrt_ec")
    dataset = scene.run().dataset
    curve = page.evaluate("desaxe.valuesText()")
    rows = list(csv.reader(io.StringIO(curve)))
    column = [float(row[1]) for row in rows[1:]]
    assert column == pytest.approx(dataset["a_C"].isel(ec=0).values, rel=1e-11)


@pytest.mark.thorough
def test_the_scene_of_a_feeder_comes_back(visit, folder, tmp_path):
    page = visit(dx.explore("examples/feeder.toml", folder / "feeder.html"))
    saved(page, "#save-scene").save_as(tmp_path / "scene.toml")
    again, before = dx.scene(tmp_path / "scene.toml"), dx.scene("examples/feeder.toml")
    assert {n: v for n, v in again.inputs.items() if n not in ("theta", "alpha")} == {
        n: v for n, v in before.inputs.items() if n != "theta"
    }
    assert page.evaluate("desaxe.state.shown") == ["T_in", "N_C"]
    page.click("#more summary")
    page.fill("#number-m_slider", "2")
    settle(page)
    wanted = dx.evaluate("T_in", theta=page.evaluate("desaxe.state.theta"), **design(page))
    assert reading(page, "T_in")[0] == pytest.approx(wanted, rel=1e-7)


@pytest.mark.thorough
def test_the_table_of_values_has_every_digit(visit, several_designs, tmp_path):
    page = visit(several_designs)
    saved(page, "#save-csv").save_as(tmp_path / "values.csv")
    head, *rows = csv.reader(io.StringIO((tmp_path / "values.csv").read_text()))
    assert head[:3] == ["theta [rad]", "a_C [m/s^2] (ec = 0 mm)", "a_C_wrt_ec [1/s^2] (ec = 0 mm)"]
    assert len(rows) == 721
    for row in rows[::60]:
        for k in range(3):
            value = dx.evaluate("a_C", theta=float(row[0]), **design(page, k))
            text = row[1 + 3 * k]
            assert (text == "") == math.isnan(value)
            assert not text or float(text) == pytest.approx(value, rel=1e-12)


@pytest.mark.thorough
def test_the_picture_is_one(visit, several_designs, tmp_path):
    saved(visit(several_designs), "#save-png").save_as(tmp_path / "picture.png")
    data = (tmp_path / "picture.png").read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    width, height = (int.from_bytes(data[at : at + 4]) for at in (16, 20))
    assert width == 1800
    assert height > 1500
    assert len(data) > 50_000  # not an empty one


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
