"""Reports to hand on: what is on the page, that it is one page, and that texts stay texts."""

import base64
import re
import sys
import textwrap
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import desaxe as dx
from desaxe.cli.command import main
from desaxe.scenes.document.blocks import Document, Image, Section, Text
from desaxe.scenes.document.page import write_document
from desaxe.scenes.document.render import html, markdown
from tests.effort import first

PRESS = dx.Machine(ec=10, AB=50, BC=200, omega0=300, m_slider=4, units="mm, deg, rpm")
LOADED = PRESS.replace(F_Y=PRESS.over_theta([0, 30, 180], [-3000, 0, 0], kind="step"))
FEW = {"start": 0, "stop": 360, "num": 37}
HOSTILE = '<script>alert(1)</script> & "x" | `y` [a](http://b) _z_'
SCENE = """
title = "A press & <b>its</b> load"
outputs = ["stroke"]
[units]
length = "mm"
[mechanism]
AB = 50
BC = 200
ec = [0, 170]
[motion]
omega0 = "300 rpm"
theta = { start = 0, stop = "360 deg", num = 19 }
[masses]
m_slider = 4
[[peak]]
quantity = "T_in"
[[picture]]
file = "a.svg"
quantity = "a_C"
at = { ec = 10 }
"""


class Page(HTMLParser):
    """The headings, the cells of all tables, all words and the addresses of a page."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.rows, self.words, self.sources, self._open = [], [], [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self._open.append(tag)
        if tag == "tr":
            self.rows.append([])
        self.sources += [value for name, value in attributes if name in ("src", "href")]

    def handle_endtag(self, tag):
        self._open.pop()

    def handle_data(self, data):
        if "style" not in self._open:
            self.words.append(data)
        if {"td", "th"} & set(self._open):
            self.rows[-1].append(data)

    def under(self, first):
        """The row that begins with this cell."""
        return next(row[1:] for row in self.rows if row and row[0] == first)


def is_one_page(text):
    """Nothing is run and nothing is fetched: pictures are in the page itself."""
    page = Page(text)
    assert not {"script", "link", "iframe", "object", "form"} & set(page.tags)
    assert page.sources
    for source in page.sources:
        kind, data = re.fullmatch(r"data:image/(svg\+xml|png);base64,(.*)", source).groups()
        drawn = base64.b64decode(data)
        assert b"<script" not in drawn
        assert kind == "png" or not re.search(rb"(?:href|src)=\"(?!#)", drawn)
    assert len(text.encode()) <= 2_000_000
    assert "url(" not in text
    assert "@media print" in text
    return page


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    path = tmp_path_factory.mktemp("report") / "new" / "press.html"
    message = LOADED.report(path, ["T_in", "stroke"], theta=FEW, title=HOSTILE)
    assert message == path
    return is_one_page(path.read_text(encoding="utf-8"))


def test_inputs_and_geometry(page):
    assert page.under("ec")[:2] == ["10", "mm"]
    assert page.under("omega0")[:2] == ["300", "rpm"]
    assert page.under("F_Y")[0] == "load over theta: 3 points, step, -3000 to 0"
    assert ["30", "0"] in page.rows  # a point of the load
    assert page.under("stroke") == [f"{LOADED.events()['stroke']:.6g} mm"]
    assert HOSTILE in page.words


def test_peaks_have_angle_side_and_gradient(page):
    peak = LOADED.peak("T_in")
    assert peak["side"] == -1
    assert [f"{peak['value']:.6g}", "30", "-1"] in page.rows
    for name, slope in peak["gradient"].items():
        assert any(row[:2] == [name, f"{slope + 0.0:.6g}"] for row in page.rows), name


def test_equal_peaks_and_slopes_of_either_sign(tmp_path):
    """At ec = 0 the peak is shared by theta and -theta, as dx.peak at a small ec of either sign tells."""
    inline = PRESS.replace(ec=0)
    page = Page(
        inline.report(tmp_path / "p.html", "a_C", theta=FEW, peak=[{"quantity": "V_C"}] * 2).read_text()
    )
    slope = abs(dx.peak("V_C", **{**inline, "ec": 1e-12})["gradient"]["ec"])
    rows = [row for row in page.rows if row[:1] == ["ec"] and row[1].startswith("+-")]
    assert len(rows) == 2
    for row in rows:
        assert float(row[1].removeprefix("+-")) == pytest.approx(slope, rel=1e-5)
    assert " ".join(page.words).count("+-: at ec = 0 the peak is at theta and at -theta") == 2


def test_what_stays_in_the_frame_is_named_beside_derivatives_by_lengths():
    peaks = [{"quantity": name} for name in ("T_in", "N_C", "a_C")]
    for load, named in (
        (PRESS.over_Y([200, 250], [0, -50]), 2),
        (PRESS.over_stroke([0, 9], [-50, 0], dead_centre="outer"), 0),
    ):
        report = str(PRESS.replace(F_Y=load).scene((), peak=peaks, theta=FEW).run())
        assert report.count("over Y stays where it is") == named


def test_drive_and_origin(page):
    drive = LOADED.drive()
    assert page.under("torque, rms") == [f"{drive['torque_rms']:.6g} N m"]
    assert page.under("numpy") == [np.__version__]


OWN = {
    "mechanism": {"ec": 0.01, "AB": 0.05, "BC": 0.2},
    "motion": {"theta": 1, "omega0": 30},
    "masses": {"m_slider": 1},
    "outputs": ["pv"],
}
OWN["quantities"] = {"pv": {"expression": "abs(N_C*V_C)/A", "unit": "W/m2", "constants": {"A": "2 cm2"}}}
MADE = {
    "step": LOADED,
    "over Y": PRESS.replace(F_Y=PRESS.over_Y([150, 250], [-10, 0], [0, 2]), branch=-1),
    "user-defined": dx.Machine(OWN),
}


@pytest.mark.parametrize("made", first(1, ["over Y", "step", "user-defined"]))
def test_its_command_makes_it_again(made, tmp_path):
    machine, path = MADE[made], tmp_path / "a.md"
    outputs = "pv" if machine.definitions else ["V_C", "T_in"]
    page = machine.report(path, outputs, theta=FEW, tolerances={"AB": 0.01}, fluctuation=0.02).read_text()
    code = re.search(r"Made by:\n\n((?:    .*\n)+)", page)[1]
    path.unlink()
    exec("import desaxe\n" + textwrap.dedent(code), scope := {})
    again = scope["machine"]
    assert dict(again) == dict(machine)
    other = re.compile(r"\| made \|.*|checksum .*|\[picture-\d+\]: .*")  # ids of a picture are its own
    assert other.sub("", path.read_text()) == other.sub("", page)
    if machine.definitions:
        dx.undefine("pv")


def test_slopes_are_in_the_units_of_the_page_and_a_torque_is_drawn_once(tmp_path):
    machine = dx.Machine(ec=10, AB=50, BC=200, omega0=300, m_slider=4000, m_rod=1000, units="mm, deg, rpm, g")
    page = Page(machine.report(tmp_path / "a.html", ["a_C", "T_in"], theta=FEW).read_text())
    units = {"ec": "N m/mm", "omega0": "N m/rpm", "m_slider": "N m/g", "m_rod": "N m/g"}
    for name, unit in units.items():
        step = 1e-3 * machine.in_units()[name]
        ends = [
            machine.replace(**{name: machine.in_units()[name] + d}).peak("T_in")["value"]
            for d in (step, -step)
        ]
        (slope,) = [row[1] for row in page.rows if row[:1] == [name] and row[2:] == [unit]]
        assert float(slope) == pytest.approx((ends[0] - ends[1]) / (2 * step), rel=1e-5), name
    words = "".join(page.words)
    assert words.count("Torque of the drive") == 1
    assert "a_C over theta" in words
    assert words.count("T_in over theta") == 1  # in the list of the values, not in a picture


def test_angles_are_those_of_a_turn_and_rounding_is_no_torque(tmp_path):
    page = Page(PRESS.report(tmp_path / "a.html", theta=FEW).read_text())
    outer = np.degrees(np.arcsin(-10 / 250)) + 360  # crank and rod in a line, C at X = -ec
    assert page.under("outer dead centre") == [f"{outer:.6g} deg"]
    assert page.under("torque, mean") == ["0 N m"]
    assert float(page.under("torque, peak")[0].split()[-2]) >= 0.0


def test_why_there_is_no_drive_is_in_the_units_of_the_page(tmp_path):
    odd = PRESS.replace(F_Y=PRESS.over_theta([0, 100, 400], [0, -5, 3], kind="linear", period=500))
    assert "its period is 500 deg" in odd.report(tmp_path / "a.md", "T_in", theta=[0, 60]).read_text()


def test_tolerances(tmp_path):
    rough = {"ec": 0.1, "AB": "0.05 mm"}
    path = PRESS.report(tmp_path / "a.html", "stroke", tolerances=rough)
    page = is_one_page(path.read_text(encoding="utf-8"))
    expected = PRESS.tolerance("stroke", ec="10 mm +- 0.1 mm", AB="50 mm +- 0.05 mm")
    ((_, value, unit, std, worst, driven),) = [
        row for row in page.rows if row[:1] == ["stroke"] and len(row) == 6
    ]
    assert (value, unit) == (f"{expected['value']:.6g}", "mm")
    assert float(std) == pytest.approx(expected["monte_carlo"]["std"], rel=0.15)
    assert worst.startswith(f"{expected['worst_case']['lower']:.6g} to {expected['worst_case']['upper']:.6g}")
    assert driven.startswith("AB ")
    said = "".join(page.words)
    assert "With ec +- 0.1 mm, AB +- 0.05 mm" in said
    assert "tolerances={'ec': 0.1, 'AB': '0.05 mm'}" in said


def test_designs_that_do_not_turn_and_loads_that_are_functions(tmp_path):
    stuck = dx.Machine(ec=[0.01, 0.17], AB=0.05, BC=0.2, omega0=-30.0, branch=-1, m_slider=1.0)
    stuck = stuck.replace(F_Y=dx.over_theta(lambda theta: -100.0 * np.cos(theta)))
    path = stuck.report(tmp_path / "a.html", "T_in", theta={"start": 0, "stop": "360 deg", "num": 37})
    page = is_one_page(path.read_text(encoding="utf-8"))
    said = "".join(page.words)
    for words in ("load over theta: the function", "of 74 points: cannot be assembled", "no (rocker)"):
        assert words in said
    assert page.under("branch")[0] == "-1"
    assert "ec = 0.17 m: status 1, " in said  # of the drive
    bare = dx.Machine(ec=0.01, AB=0.05, BC=0.2).report(tmp_path / "b.html", theta=[0, 1, 2])
    assert "Drive" not in is_one_page(bare.read_text(encoding="utf-8")).words


def test_markdown(tmp_path):
    path = PRESS.report(tmp_path / "a.md", "a_C", theta=FEW, title=HOSTILE)
    text = path.read_text(encoding="utf-8")
    assert text.startswith(
        '# &lt;script&gt;alert(1)&lt;/script&gt; &amp; "x" \\| \\`y\\` \\[a\\](http://b) \\_z\\_\n'
    )
    assert "<script" not in text
    assert "| ec | 10 | mm | eccentricity: the slider axis is at X = -ec |" in text
    assert re.search(r"^!\[.*\]\[picture-1\]$", text, re.M)
    assert re.search(r"^\[picture-1\]: data:image/svg\+xml;base64,\S+$", text, re.M)
    assert len(text.encode()) <= 2_000_000


def test_places_and_complaints(tmp_path, monkeypatch):
    path = tmp_path / "a.html"
    path.write_text("mine")
    monkeypatch.setattr("desaxe.machine.report.compute", lambda *_: pytest.fail("something was computed"))
    with pytest.raises(FileExistsError, match="exists and was not written by desaxe"):
        PRESS.report(path)
    with pytest.raises(ValueError, match=r"a\.pdf: a report is written as \.html or \.md"):
        PRESS.report(tmp_path / "a.pdf")
    with pytest.raises(ValueError, match="tolerances: 'mu' is no input here that is a number: AB, BC, ec"):
        PRESS.report(tmp_path / "b.html", tolerances={"mu": 0.1})
    with pytest.raises(ValueError, match="ec = -1: it must be finite and at least 0"):
        PRESS.report(tmp_path / "b.html", tolerances={"ec": -1})
    with pytest.raises(TypeError, match="leave results out"):
        PRESS.report(tmp_path / "b.html", results={"data": "a.nc"})
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(ImportError, match=r"a report needs matplotlib.*'desaxe\[plot\]'"):
        PRESS.report(tmp_path / "b.html")
    assert path.read_text() == "mine"
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a.html"]


def test_pictures_that_are_too_large_are_left_out(tmp_path):
    image = Image("many curves", "png", bytes(1_000_000))
    result = Document("d", [Section("s", [image, image, Text("t" * 400_000)])])
    for name, form in (("a.html", html), ("a.md", markdown)):
        text = write_document(result, tmp_path / name).read_text(encoding="utf-8")
        assert len(text.encode()) <= 2_000_000 < len(form(result).encode())
        assert "many curves: left out, a report has at most 2 MB" in text


@pytest.mark.thorough
def test_the_command_line(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("press.toml").write_text(SCENE, encoding="utf-8")
    words = ["run", "press.toml", "--report", "out/page.html", "--tolerance", "ec=0.1 mm"]
    assert main(words) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert "out/page.html" in out
    page = is_one_page(Path("out/page.html").read_text(encoding="utf-8"))
    said = "".join(page.words)
    assert "A press & <b>its</b> load" in said
    assert "desaxe run press.toml --report out/page.html --tolerance 'ec=0.1 mm'" in said
    assert "With ec +- 0.1 mm for ec = 0 mm" in said
    assert "a_C over theta" in said  # the picture of the scene
    assert "Largest magnitude of T_in" in said
    Path("out/page.html").write_text("mine")
    assert main(words) == 2
    assert "out/page.html exists and was not written by desaxe" in capsys.readouterr().err
    assert main([*words, "--overwrite"]) == 0
    for bad, message in (
        (["--report", "a.txt"], "a.txt: a report is written as .html or .md"),
        (["--report", "\x1b[2Ja.txt"], "\\x1b[2Ja.txt: a report is written"),
        (["--report", "./b.md", "--tolerance", "ec"], "--tolerance ec: expected INPUT=HALF"),
        (["--tolerance", "ec=1"], "--tolerance is for the report: give --report FILE"),
        (["--report", "b.md", "--tolerance", "ec=1 kg"], "ec = '1 kg'"),
    ):
        capsys.readouterr()
        assert main(["run", "press.toml", *bad]) == 2
        assert message in capsys.readouterr().err
    assert not Path("b.md").exists()
