"""Generated files: written where nothing else is lost, compared with those that are there."""

import pytest

from desaxe.support.written import Generated


def test_files_are_written_once_all_of_them_may_be(tmp_path):
    (tmp_path / "b.py").write_text("a stranger's")
    both = Generated(tmp_path, {"a.py": "one\n", "b.py": "two\n"})
    with pytest.raises(FileExistsError, match=r"b\.py"):
        both.write(False)
    assert not (tmp_path / "a.py").exists()
    both.write(True)
    assert (both.stale(), [*both.diff()]) == ([], [])
    assert both.summary() == [f"{tmp_path / 'a.py'}: 1 lines", f"{tmp_path / 'b.py'}: 1 lines"]


def test_differences_are_told_line_by_line(tmp_path):
    made = Generated(tmp_path, {"a.py": "one\ntwo\n", "b.py": "", "c.py": None})
    made.write(False)
    assert made.stale() == []
    (tmp_path / "a.py").write_text("one\n2\n")
    (tmp_path / "b.py").unlink()
    (tmp_path / "c.py").write_text("old\n")
    assert made.stale() == ["a.py", "b.py", "c.py"]
    message = [*made.diff()]
    assert {"-2", "+two", "b.py is missing", "c.py is not wanted"} < set(message)
