"""The page in a real browser: its curves, and what is read from them."""

import math
import re

import pytest

import desaxe as dx
from tests.scenes.explorer.page import FINITE, design, drawn_lines, reading, settle, verdict


def next_to_a_limit(theta, lengths):
    """True within a few doubles of a limit angle, where the page, unlike Python, may be undecided."""
    away = 4 * math.ulp(theta)
    near = (dx.evaluate("status", theta=angle, **lengths) for angle in (theta - away, theta + away))
    return len(set(near)) > 1


def contrast(one, other):
    """The contrast ratio of two colours such as #1b2330."""
    lights = []
    for colour in (one, other):
        parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
        linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
        lights.append(0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2])
    return (max(lights) + 0.05) / (min(lights) + 0.05)


def swipe_up(page, x, y, length):
    finger = page.context.new_cdp_session(page)
    for k in range(11):
        at = {"x": x, "y": y - length * k / 10}
        finger.send(
            "Input.dispatchTouchEvent", {"type": "touchMove" if k else "touchStart", "touchPoints": [at]}
        )
    finger.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})


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
    message = [
        (value is not None, math.isfinite(dx.evaluate("V_C", theta=theta, **lengths)))
        for theta, value in zip(curve["theta"], curve["value"], strict=True)
        if not next_to_a_limit(theta, lengths)
    ]
    assert len(message) >= len(curve["theta"]) - 4
    assert [ours for ours, _ in message] == [python for _, python in message]
    assert curve["theta"] == sorted(curve["theta"])


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
    expected = [dx.evaluate("V_C", theta=math.pi / 3, **design(page, k)) for k in range(3)]
    assert reading(page, "V_C") == [pytest.approx(v, rel=1e-7) for v in expected]
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
