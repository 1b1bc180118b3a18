"""Tables as spreadsheets, loggers and oscilloscopes of several countries write them, and frames."""

import codecs
import math
import random
import sys

import numpy as np
import pandas
import pytest

import desaxe as dx
from desaxe.design.fit.data import read_data
from desaxe.support.extras import MissingExtraError
from desaxe.units.parse import factor_to_si, in_unit
from desaxe.units.scaling import by_digits

ANGLES, FORCES = [0.0, math.pi / 2, math.pi], [0.0, -400.5, -50.0]
# What stands in each file: 0, 90 and 180 deg; 0, -400.5 and -50 N.
FILES = {
    "plain, in SI units": "0,0\n1.5707963267948966,-400.5\n3.141592653589793,-50\n",
    "a spreadsheet in Germany": codecs.BOM_UTF8 + b"theta [deg];a_C [N]\r\n0;0\r\n90;-400,5\r\n180;-50\r\n",
    "a spreadsheet in France": b"theta [\xb0];a_C (kN)\r\n0,0;0\r\n90,0;-0,4005\r\n180,0;-0,05\r\n",
    "a spreadsheet in the USA": '"theta (deg)","a_C, N"\n"0","0"\n"90","-400.5"\n"180","-5.0E+01"\n',
    "a Unicode text": "theta [deg]\ta_C [N]\r\n0\t0\r\n90\t-400,5\r\n180\t-50\r\n".encode("utf-16"),
    "a line that names the separator": "sep=;\r\ntheta [deg];a_C [N]\r\n0;0\r\n90;-400,5\r\n180;-50\r\n",
    "ends of lines of old": "theta [deg],a_C [N]\r0,0\r90,-400.5\r180,-50\r",
    "one width": "theta [deg]  a_C [N]\n    0.0        0.0\n   90.0     -400.5\n  180.0      -50.0\n",
    "one width and commas": "theta [deg]  a_C [kN]\n  0,0    0,0\n 90,0  -0,4005\n180,0  -0,05\n",
    "commas and blanks": "theta [deg],  a_C [N]\n  0.0,    0.0\n 90.0, -400.5\n180.0,  -50.0\n",
    "a comment as heading": "# press 4\n# theta [deg] a_C [N]\n0.0e+00 0\n9e+01 -4.005e+02\n1.8e2 -50\n",
    "an oscilloscope": "Model,DSO 4,\nInterval,1e-3\n\ntheta,a_C\n(deg),(N)\n\n0,0\n90,-400.5\n180,-50\n",
    "a logger with a line of units": "theta;a_C;T\ndeg;N;°C\n0;0;20,5\n90;-400,5;\n180;-50;21,5\n",
    "units between the names": "theta, deg, a_C, kN\n0, 0\n90, -0.4005\n180, -0.05\n",
    "units behind a stroke": "theta / deg;a_C / kN\n0;0\n90;-0,4005\n180;-0,05\n",
    "notes": 'theta [deg],a_C [N],note\n0,0,"start; of\nthe stroke"\n90,-400.5,"1,5 mm ""left"""\n180,-50,\n',
    "a remark": "press 4\n0,0,-\n1.5707963267948966,-400.5,-\n3.141592653589793,-50,a\n",
    "settings": "Interval,1e-3\n0,0,x\n1.5707963267948966,-400.5,y\n3.141592653589793,-50,z\n",
    "remarks and empty lines": "# 4.3.\n\ntheta [deg];a_C [N]\n0;0\n# halt\n;;\n90;-400.5\n180;-50\n\n",
    "a separator at the end": "theta [deg];a_C [N];\n0;0;\n90;-400,5;\n180;-50;\n",
}  # fmt: skip

WITHOUT_HEADING = ("plain, in SI units", "a remark", "settings")


def written(folder, content):
    path = folder / "press.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


@pytest.mark.parametrize("name", FILES)
def test_files_of_many_kinds_are_one_load(name, tmp_path):
    load = dx.over_theta.read(written(tmp_path, FILES[name]), kind="linear")
    table = load.tables[0]
    assert (list(table.knots), list(table.values)) == (ANGLES, FORCES)


@pytest.mark.parametrize("name", [name for name in FILES if name not in WITHOUT_HEADING])
def test_files_of_many_kinds_are_one_measurement(name, tmp_path):
    content = FILES[name]
    content = content if isinstance(content, bytes) else content.encode()
    wide = content.startswith(codecs.BOM_UTF16_LE)
    text = content.decode("utf-16") if wide else content.decode("cp1252")
    for force, other in (("kN", "km/s2"), ("N", "m/s2")):
        text = text.replace(force, other) if force in text else text
    data = read_data(written(tmp_path, text.encode("utf-16" if wide else "cp1252")), False)
    np.testing.assert_array_equal(data.at, ANGLES)
    np.testing.assert_array_equal(data.measured["a_C"], FORCES)


@pytest.mark.parametrize("seed", range(40))
def test_any_mixture_of_dialects_is_read(seed, tmp_path):
    chance = random.Random(seed)
    separator, mark = chance.choice([(",", "."), *((between, mark) for between in ";\t " for mark in ".,")])
    unit = chance.choice(["m", "mm", "cm"])
    form = chance.choice(["{0} [{1}]", "{0}({1})", "{0} [{1}]\n({1})", "{0}\n{1}"])
    numbers = [[chance.randint(-500, 500) / 8 for _ in range(3)] for _ in range(chance.randint(2, 30))]
    quote = chance.choice(["", '"'])
    rows = [[index, *row] for index, row in enumerate(numbers)]
    lines = [separator.join(f"{quote}{x!r}{quote}".replace(".", mark) for x in row) for row in rows]
    heads = form.format("Y", unit).split("\n"), form.format("out", "kN").split("\n")
    width = 4 if separator == "," else 3
    top = [separator.join([*pair, pair[1], ""][:width]) for pair in zip(*heads, strict=True)]
    for remark in chance.sample(["# 12 strokes, 7 mm", "", separator * 2 if separator != " " else ""], 2):
        lines.insert(chance.randint(0, len(lines)), remark)
    end = chance.choice(["\n", "\r\n", "\r"])
    text = end.join([*top, *lines]) + chance.choice(["", end])
    read = dx.over_Y.read(written(tmp_path, text.encode(chance.choice(["utf-8", "utf-8-sig", "utf-16"]))))
    places = [f"{index} {unit}" for index in range(len(rows))]
    assert read == dx.over_Y(places, *([f"{row[k]} kN" for row in numbers] for k in (0, 1)))


REFUSED = {
    "theta [deg];F [N]\n0;0\n90;-1.000,5\n": r"line 3, column 2 \(value\): '-1.000,5' .* one decimal mark",
    "theta [deg];F [N]\n0;0,5\n90;1.5\n": r"line 3, column 2 \(value\): '1.5' .* one decimal mark",
    'theta [deg],F [N]\n0,0\n90,"-400,5"\n': r"line 3, column 2 .* '-400,5' is not .* semicolons or tabs",
    "theta,F\n0,0\n0,5,1,5\n": r"line 3, column 3 \(no heading\): .* semicolons or tabs",
    "theta;F\n0;0\n1 234;7\n": r"line 3, column 1 \(theta\): '1 234' is not .* marks between thousands",
    "theta;F\n# halt\n\n0;0\n1;2'345\n": r"line 5, column 2 .* without marks between thousands",
    "theta [deg];F [N]\n0;0\n90;\n": r"line 3, column 2 \(value\): the cell is empty; every row needs",
    "theta;F\n;7\n1;2\n": r"line 2, column 1 \(theta\): the cell is empty",
    "0;0\n7\n": r"line 2, column 2 \(value\): the cell is empty",
    "0;0\n1;nan\n": r"line 2, column 2 \(value\): the cell is empty",
    '0;0\n1;"5\n6"\n': r"line 3, column 2",
    "theta;F\n0;0\n90;inf\n": r"line 3, column 2 \(value\): 'inf' is not a finite number; write a number",
    "90;5 N\n180;6 N\n": r"line 1, column 2 \(value\): '5 N' is not .* without a unit",
    "0;0\nninety;7\n": r"line 2, column 1 \(theta\): 'ninety' is not",
    ",theta,F\n0,0,0\n1,90,-4\n": "the first column has no heading, as the index of a frame",
    "theta;F\n\n": "no line begins with two numbers",
    "": "no line begins with two numbers",
    "theta [dge];F [N]\n0;0\n90;5\n": "over_theta: angles in 'dge': unknown unit",
    "theta [mm];F [N]\n0;0\n90;5\n": "over_theta: angles in 'mm': it must be a quantity in rad",
    "theta [deg];T [Nm]\n0;0\n90;5\n": "over_theta: values in 'Nm': unknown unit; did you mean N m",
    "theta [deg];F\n(rad);(N)\n0;0\n1;5\n": "theta = 'deg', but its heading is '\\(rad\\)'",
}


@pytest.mark.parametrize("content", REFUSED)
def test_what_is_refused_is_named_with_its_file_line_column_and_remedy(content, tmp_path):
    with pytest.raises(ValueError, match=rf"press\.csv[,:] {REFUSED[content]}"):
        dx.over_theta.read(written(tmp_path, content), kind="linear")


@pytest.mark.parametrize("content", [b"PK\x03\x04\0\0", "0;0\n".encode("utf-16-le"), b"0;\x81\n"])
def test_what_is_no_text_is_refused(content, tmp_path):
    with pytest.raises(ValueError, match=r"press\.csv: not a text; save the table as a text in UTF-8"):
        dx.over_theta.read(written(tmp_path, content))


def test_an_empty_cell_stays_in_its_column(tmp_path):
    """The third column is the load inward; one without numbers is none, whatever stands behind it."""
    read = dx.over_Y.read(written(tmp_path, "0.2,100,,7\n0.3,200,,8\n"))
    assert read == dx.over_Y([0.2, 0.3], [100, 200])
    with pytest.raises(ValueError, match=r"line 2, column 3 \(inward\): the cell is empty"):
        dx.over_Y.read(written(tmp_path, "0.2,100,5,7\n0.3,200,,8\n"))
    data = read_data(written(tmp_path, "theta,a_C,V_C\n0,1,\n,2,3\n1,,4\n"), False)
    np.testing.assert_array_equal(data.measured["a_C"], [1.0, np.nan, np.nan])
    np.testing.assert_array_equal(data.measured["V_C"], [np.nan, np.nan, 4.0])


def test_a_line_of_units_may_be_shorter_than_the_heading(tmp_path):
    data = read_data(written(tmp_path, "theta;a_C\n(deg)\n180;2\n"), False)
    assert (data.at.tolist(), data.measured["a_C"].tolist()) == ([math.pi], [2.0])


def test_units_of_one_way_are_those_of_the_other_unless_it_has_its_own(tmp_path):
    for heads in ("Y [mm];out [kN];in [kN]", "Y [mm];out [kN];in", "Y [mm];out;in [kN]", "mm;kN;in"):
        read = dx.over_Y.read(written(tmp_path, f"{heads}\n200;1;2\n300;1,5;0\n"))
        assert read == dx.over_Y(["200 mm", "300 mm"], ["1 kN", "1.5 kN"], ["2 kN", "0 kN"])
    read = dx.over_Y.read(written(tmp_path, "Y [mm];out [kN];in [N]\n200;1;2\n300;1,5;0\n"))
    assert read == dx.over_Y(["200 mm", "300 mm"], ["1 kN", "1.5 kN"], ["2 N", "0 N"])


class OfPolars:
    """A frame with what polars and pandas have in common."""

    def __init__(self, columns):
        self.columns, self._columns = list(columns), columns

    def __getitem__(self, name):
        return pandas.Series(self._columns[name])


DEGREES = {"theta [deg]": [0, 90, 180], "F_Y (kN)": [0.0, -0.4005, -0.05]}


@pytest.mark.parametrize("frame", [pandas.DataFrame, OfPolars])
def test_frames_and_workbooks(frame, tmp_path):
    press = dx.over_theta([f"{angle} deg" for angle in (0, 90, 180)], ["0 N", "-400.5 N", "-50 N"], "linear")
    assert dx.over_theta.read(frame(DEGREES), kind="linear") == press
    texts = {"theta": ["0", "90", "180"], "F": ["0", "-400.5", "-50"]}
    assert dx.over_theta.read(frame(texts), theta="deg", value="N", kind="linear") == press
    with pytest.raises(ValueError, match=r"data, row 2, column 2 \(value\): the cell is empty"):
        dx.over_theta.read(frame({"theta": [0.0, 1.0], "F": [1.0, None]}))
    data = read_data(frame({"theta [deg]": DEGREES["theta [deg]"], "a_C, km/s2": DEGREES["F_Y (kN)"]}), False)
    np.testing.assert_array_equal(data.at, ANGLES)
    np.testing.assert_array_equal(data.measured["a_C"], FORCES)


def test_workbooks(tmp_path):
    path = tmp_path / "press.xlsx"
    with pandas.ExcelWriter(path) as book:
        pandas.DataFrame(DEGREES).to_excel(book, index=False, startrow=2)
    assert list(dx.over_theta.read(path, kind="linear").tables[0].values) == FORCES
    pandas.DataFrame({"theta": [0, 1], "F": [1, "x"]}).to_excel(path, index=False)
    with pytest.raises(
        ValueError, match=r"press\.xlsx, row 3, column 2 \(value\): 'x' is not a finite number"
    ):
        dx.over_theta.read(path)


@pytest.mark.parametrize(
    ("missing", "end", "remedy"),
    [
        ("openpyxl", "xlsx", r"needs openpyxl: python -m pip install 'desaxe\[excel\]'"),
        ("pandas", "xlsx", r"needs pandas: python -m pip install 'desaxe\[excel\]'"),
        ("xlrd", "xls", "needs xlrd; or save it as .xlsx"),
    ],
)
def test_a_workbook_without_its_reader_names_the_extra(missing, end, remedy, monkeypatch):
    monkeypatch.setitem(sys.modules, missing, None)
    with pytest.raises(MissingExtraError, match=rf"the workbook die\.{end} {remedy}"):
        dx.over_stroke.read(f"die.{end}", dead_centre="outer")


@pytest.mark.parametrize("heads", ["theta,a_C", "theta [deg],a_C [mm/s2]", "theta, deg;a_C, m/s2"])
def test_plain_numbers_of_a_file_are_in_the_units_of_the_machine(heads, tmp_path):
    """Measurements of a known machine, by the loop closure of a crank of 40 mm."""
    ec, AB, BC, omega = 12.0, 40.0, 130.0, 30.0
    theta = np.linspace(0.0, 354.0, 60)

    def Y(angle):
        return AB * np.cos(angle) + np.sqrt(BC**2 - (ec + AB * np.sin(angle)) ** 2)

    at, h = np.radians(theta), 1e-4
    a_C = omega**2 * (Y(at + h) - 2 * Y(at) + Y(at - h)) / h**2  # mm/s^2
    scale, separator = (1e-3, ";") if ";" in heads else (1.0, ",")
    rows = zip(theta.tolist(), (scale * a_C).tolist(), strict=True)
    lines = [f"{x!r}{separator}{y!r}" for x, y in rows]
    path = written(tmp_path, "\n".join([heads, *lines]))
    press = dx.Machine(units="mm, deg, rpm", omega0=omega * 30 / math.pi, AB=AB)
    result = press.fit(path, over={"ec": (5.0, 20.0), "BC": (100.0, 150.0)}, sigma={"a_C": 1.0})
    assert result["value"]["ec"] == pytest.approx(ec, rel=1e-4)
    assert result["value"]["BC"] == pytest.approx(BC, rel=1e-4)


def test_many_digits_and_units_are_rounded_once():
    """A column in a unit is what the same decimals are as texts with it."""
    chance = np.random.default_rng(1)
    for digits in (1, 3, 6, 9, 12):
        numbers = np.round(chance.uniform(-400.0, 400.0, 500), digits)
        for unit, si in (("deg", "rad"), ("turn", "rad"), ("mm", "m"), ("kN", "N"), ("inch", "m")):
            column = by_digits(numbers, factor_to_si("x", unit, si)).tolist()
            assert column == [in_unit("x", f"{number!r} {unit}", si) for number in numbers.tolist()]
