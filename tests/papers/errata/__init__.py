"""The ledgers of the papers' errata, one TOML file a paper, and their page: `python -m tests.papers.errata`.

ledger     the entries and the worst of each paper: read and filtered
marks      the marks in their texts that the tests compare; what a correction changes
page       as the Markdown page docs/ERRATA.md
equations  the numbered equations: wrong and right ones
formula    the ledgers' ASCII mathematics, parsed, and as LaTeX
"""
