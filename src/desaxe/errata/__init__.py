"""The ledgers of the papers' errata, one TOML file a paper; `desaxe.errata.ledger` reads them.

ledger     the entries and the worst of each paper: read and filtered
marks      the marks in their texts that the tests compare; what a correction changes
terminal   as text for a terminal
page       as a Markdown page
equations  the numbered equations: wrong and right ones
formula    the ledgers' ASCII mathematics, parsed, and as LaTeX
search     entries by id, equation number or words
"""
