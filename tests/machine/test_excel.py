"""Workbooks: what is in the cells, units in the headings, texts that stay texts."""

import math
import sys

import numpy as np
import openpyxl
import pytest

import desaxe as dx

PRESS = dx.Machine(ec=10, AB=50, BC=200, omega0=300, m_slider=4, units="mm, deg, rpm")
LOADED = PRESS.replace(F_Y=PRESS.over_theta([0, 30, 180], [-3000, 0, 0], kind="step"))


def sheets(path):
    book = openpyxl.load_workbook(path)
    return {sheet.title: [list(row) for row in sheet.values] for sheet in book}


def numbers(path, sheet="values"):
    """The rows of a sheet of names, values and units."""
    head, *rows = sheets(path)[sheet]
    assert head == ["name", "value", "unit"]
    return {name: (value, unit) for name, value, unit in rows}


def test_a_grid_in_its_own_units_with_designs_that_do_not_turn(tmp_path):
    result = LOADED.grid(["T_in", "a_C"], theta=[0, 30, 60], ec=[0, 180])
    book = sheets(dx.to_excel(result, tmp_path / "new" / "a.xlsx"))
    head, *rows = book["values"]
    assert head == ["theta [deg]", "ec [mm]", "T_in [N*m]", "a_C [mm/s^2]", "status", "margin [mm]"]
    assert len(rows) == 6
    for (theta, ec), row in zip([(t, e) for t in (0, 30, 60) for e in (0, 180)], rows, strict=True):
        one = result.sel(theta=theta, ec=ec)
        assert row[:2] == [theta, ec]
        assert row[4] == int(one.status)
        value = float(one.T_in)
        assert row[2] is None if math.isnan(value) else row[2] == pytest.approx(value, rel=1e-14)
    assert None in [row[2] for row in rows]
    about = {row[1]: row[2:4] for row in book["about"]}
    assert about["AB"] == [50, "mm"]
    assert "load over theta: 3 points, step" in about["loads"][0]
    assert sheets(dx.to_excel(result.T_in, tmp_path / "b.xlsx"))["values"][0][-1] == "T_in [N*m]"


def test_answers_in_the_units_of_a_machine(tmp_path):
    peak = LOADED.peak("T_in")
    result = numbers(dx.to_excel(peak, tmp_path / "a.xlsx"))
    assert result["value"] == (pytest.approx(peak["value"]), "N*m")
    assert result["theta"] == (30, "deg")
    assert result["side"] == (-1, None)
    assert result["gradient.ec"] == (pytest.approx(peak["gradient"]["ec"]), "N*m/mm")
    drive = numbers(dx.to_excel(LOADED.drive(), tmp_path / "b.xlsx"))
    assert drive["torque_peak"][1] == "N*m"
    assert drive["ec"] == (LOADED.in_units()["ec"], "mm")
    assert drive["gradient.torque_rms.ec"][1] == "N*m/mm"
    spread = LOADED.tolerance("a_C", theta=60, ec="10 +- 0.1", samples=100)
    result = numbers(dx.to_excel(spread, tmp_path / "c.xlsx"))
    assert result["first_order.std"] == (pytest.approx(spread["first_order"]["std"]), "mm/s^2")
    head, *rows = sheets(dx.to_excel(PRESS.evaluate(["a_C"], theta=[0, 90]), tmp_path / "d.xlsx"))["values"]
    assert (head, len(rows)) == (["a_C [mm/s^2]"], 2)


def test_answers_of_functions_are_in_si_units(tmp_path):
    theta = np.linspace(0, 1, 3)
    result = dx.evaluate(["a_C", "V_C"], theta=theta, ec=0.01, AB=0.05, BC=0.2, omega0=3)
    path = dx.to_excel(result, tmp_path / "a.xlsx")
    head, *rows = sheets(path)["values"]
    assert head == ["theta [rad]", "a_C [m/s^2]", "V_C [m/s]"]
    np.testing.assert_allclose(
        np.array(rows, float), np.array([theta, result["a_C"], result["V_C"]]).T, 1e-14
    )
    assert numbers(path, "numbers")["omega0"] == (3, "rad/s")
    peak = dx.to_excel(dx.peak("a_C", ec=[0.0, 0.01], AB=0.05, BC=0.2, omega0=3), tmp_path / "b.xlsx")
    assert "gradient.BC [1/s^2]" in sheets(peak)["values"][0]
    said = dx.to_excel({"a_C": 5.0}, tmp_path / "c.xlsx", units="mm, deg, rpm")
    assert numbers(said)["a_C"] == (5, "mm/s^2")


def test_texts_stay_texts_and_numbers_without_a_value_are_told(tmp_path):
    path = dx.to_excel(
        {"x": '=HYPERLINK("a")', "none": None, "v": [1.0, math.nan, -math.inf]}, tmp_path / "a.xlsx"
    )
    book = openpyxl.load_workbook(path)
    assert [row[0] for row in book["values"].iter_rows(min_row=2, values_only=True)] == [1, None, "-inf"]
    (cell,) = [row[1] for row in book["numbers"].iter_rows() if row[0].value == "x"]
    assert (cell.value, cell.data_type, cell.hyperlink) == ('=HYPERLINK("a")', "s", None)


def test_places_and_complaints(tmp_path, monkeypatch):
    path = tmp_path / "a.xlsx"
    path.write_text("mine")
    with pytest.raises(FileExistsError, match="exists and was not written by desaxe"):
        dx.to_excel({"a": 1.0}, path)
    assert path.read_text() == "mine"
    dx.to_excel({"a": 1.0}, path, overwrite=True)
    dx.to_excel({"a": 2.0}, path)  # its own file is replaced
    assert numbers(path)["a"][0] == 2
    with pytest.raises(ValueError, match=r"a\.xls: a workbook is written as \.xlsx"):
        dx.to_excel({"a": 1.0}, tmp_path / "a.xls")
    with pytest.raises(TypeError, match="expected a Dataset or a dict of answers, got 3"):
        dx.to_excel(3, path)
    with pytest.raises(ValueError, match=r"1048576 rows, a sheet of \.xlsx holds 1048576"):
        dx.to_excel({"a": np.zeros(1048576)}, path)
    monkeypatch.setitem(sys.modules, "xlsxwriter", None)
    with pytest.raises(ImportError, match=r"needs xlsxwriter.*'desaxe\[excel\]'"):
        dx.to_excel({"a": 1.0}, path)
    assert numbers(path)["a"][0] == 2


def test_too_many_rows_are_refused_before_a_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scene = PRESS.scene("a_C", theta={"start": 0, "stop": 360, "num": 1048576}, results={"data": "a.xlsx"})
    with pytest.raises(ValueError, match=r"results\.data: 1048576 rows"):
        scene.run()
