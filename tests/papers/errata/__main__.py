"""Write docs/ERRATA.md from the ledgers."""

from pathlib import Path

from .page import markdown

PAGE = Path(__file__).resolve().parents[3] / "docs" / "ERRATA.md"

if __name__ == "__main__":
    PAGE.write_text(markdown() + "\n", encoding="utf-8")
