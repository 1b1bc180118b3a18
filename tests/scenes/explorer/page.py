"""Helpers that read the page in a browser."""

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


def figure(page, name):
    """A row of the figures of each design."""
    return page.locator(f"#figures tr[data-figure='{name}'] td").all_inner_texts()


def saved(page, button):
    with page.expect_download() as waiting:
        page.click(button)
    return waiting.value
