"""Files of a release: the workflow and forms of the repository, the citation, the version."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from tests.repository.contract import FILE, lines

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]


@pytest.mark.parametrize(
    ("schema", "file"),
    [
        ("github-workflows", ".github/workflows/ci.yml"),
        ("github-issue-forms", ".github/ISSUE_TEMPLATE/bug.yml"),
        ("citation-file-format", "CITATION.cff"),
    ],
)
def test_a_file_of_the_forge_is_valid(schema, file):
    command = [sys.executable, "-m", "check_jsonschema", "--builtin-schema", f"vendor.{schema}", ROOT / file]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


def test_the_citation_and_the_changelog_have_the_version():
    cited = re.search(r"^version: (\S+)$", (ROOT / "CITATION.cff").read_text("utf-8"), re.M)[1]
    newest = re.search(r"^## (\S+)", (ROOT / "CHANGELOG.md").read_text("utf-8"), re.M)[1]
    assert cited == newest == PROJECT["version"]


def test_the_workflow_covers_the_pythons_that_are_declared():
    declared = [entry.rpartition(" ")[2] for entry in PROJECT["classifiers"] if "Python :: 3." in entry]
    workflow = (ROOT / ".github/workflows/ci.yml").read_text("utf-8")
    covered = re.search(r"python: \[(.*)\]", workflow)[1].replace('"', "").split(", ")
    assert covered == [declared[0], declared[-1]]


def test_nothing_of_the_contract_is_gone_or_changed():
    """A new line is no breach: `python -m tests.repository.contract` adds it to the list before a release."""
    assert not {*FILE.read_text("utf-8").splitlines()} - {*lines()}
