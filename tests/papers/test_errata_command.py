"""`desaxe errata`: found by number, by word, by what is wrong; on a narrow terminal; as JSON."""

import json

import pytest

from desaxe.cli import main
from desaxe.errata.equations import FINE
from desaxe.errata.ledger import conventions, documents, entries, harm, title
from desaxe.errata.search import matching
from desaxe.errata.terminal import table


def shown(capsys, *words):
    """The output of `desaxe errata` with these words."""
    assert main(["errata", *words]) == 0
    return capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "ids"),
    [
        (["eq20"], ["A-eq20", "B-eq20"]),
        (["Eq.", "20"], ["A-eq20", "B-eq20"]),
        (["equation (20)"], ["A-eq20", "B-eq20"]),
        (["b-EQ20"], ["B-eq20"]),
        (["eq37"], ["B-eq37a", "B-eq37b"]),
        (["eq42b"], ["B-eq42b"]),
        (["listing-pinv"], ["C-listing-pinv"]),
        (["round", "ends", "0.76557"], ["C-listing-m2"]),
        (["no such words anywhere"], []),
    ],
)
def test_words_find_entries(words, ids):
    assert [entry.id for entry in matching(entries(), words)] == ids


def test_an_equation_is_told_with_its_paper(capsys):
    out = shown(capsys, "eq20", "--paper", "B")
    flat = " ".join(out.split())
    assert title("B") in flat
    assert all(" ".join(note.split()) in flat for note in conventions("B"))
    assert "B-eq20" in out
    assert "A-eq20" not in out
    assert r"\frac" in out
    assert "13.7 million" in flat


def test_wrong_entries_only(capsys):
    found = json.loads(shown(capsys, "--wrong", "--json", "--document", "c"))
    assert found
    assert not {entry["verdict"] for entry in found} & set(FINE)


def test_json_has_proof_and_paper(capsys):
    (found,) = json.loads(shown(capsys, "B-eq10", "--json"))
    assert found["test"] == "tests/papers/test_paper_equations.py::test_equation[B-eq10]"
    assert found["paper"] == title("B")
    assert found["conventions"] == list(conventions("B"))
    assert found["latex_corrected"].startswith("s = k + c - k")


def test_markdown_of_some(capsys):
    page = shown(capsys, "--markdown", "--document", "A", "--verdict", "sign")
    assert page.count("): **sign**") == 3
    assert "Paper B" not in page


def test_terminal_width(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "60")
    out = shown(capsys, "--document", "A", "--wrong")
    assert out.splitlines()
    assert all(len(line) <= 60 for line in out.splitlines() if " " in line.strip())


def test_wrong_equations_in_a_line_each(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "400")
    out = shown(capsys, "--equations")
    assert sum(line.startswith("  Eq. ") for line in out.splitlines()) == 18
    assert "Paper A: of 25 numbered equations 1 wrong." in out
    assert "Paper B: of 58 numbered equations 17 wrong." in out
    assert "Paper C numbers no equation." in out
    assert r"\sqrt" in shown(capsys, "--equations", "--latex")


def test_the_harm_without_a_choice(capsys):
    out = shown(capsys)
    assert len(out.splitlines()) <= 60
    flat = " ".join(out.split())
    for letter in documents():
        assert title(letter) in flat
        assert all(row.what in flat and row.cost in flat for row in harm(letter))
    assert "{-}AB*omega(theta)*sin(theta) {-} BC*omega_BC" in flat
    assert "-R12y R12x -R32y {+}R32x 0 0 0 1;" in flat
    assert all(word in flat for word in ("B-eq17", "--paper", "--all", "--equations"))


def test_everything(capsys):
    out = shown(capsys, "--all")
    assert all(entry.id in out for entry in entries())
    assert out.rstrip().endswith(" ".join(table(entries()).rsplit("\n", 1)[-1].split()))


def test_a_paper_begins_with_its_harm(capsys):
    out = shown(capsys, "--paper", "b")
    assert out.index(harm("B")[0].what) < out.index("B-eq1 ")
    assert all(entry.id in out for entry in entries("B"))
    assert title("A") not in " ".join(out.split())
    assert harm("B")[0].what not in shown(capsys, "--paper", "B", "--wrong")
