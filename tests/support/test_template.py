"""Text files with places for values."""

import pytest

from desaxe.compiler import languages
from desaxe.support.template import file_text, filled


def test_a_place_with_a_line_of_its_own_takes_lines():
    text = "def f():\n    @LINES@\n    return @VALUE@, @VALUE@\n"
    assert filled(text, LINES=["a = 1", "", "b = 2"], VALUE="a") == (
        "def f():\n    a = 1\n\n    b = 2\n    return a, a\n"
    )
    assert filled(text, LINES=[], VALUE="0") == "def f():\n    return 0, 0\n"


def test_values_are_not_read_again():
    assert filled("@A@ @B@ @njit x@y.org", A="@B@", B=r"\1") == r"@B@ \1 @njit x@y.org"


def test_a_place_without_a_value_is_named():
    with pytest.raises(KeyError, match="MISSING"):
        filled("@MISSING@")


def test_files_are_those_of_the_package():
    assert "two_sum_error" in file_text(languages.__name__, "octave.m")
