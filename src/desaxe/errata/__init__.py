"""The ledgers of the papers' errata, one TOML file a paper; `desaxe.errata.ledger` reads them.

ledger     the entries: read, filtered, as text and as Markdown
equations  the numbered equations: wrong and right ones
formula    the ledgers' ASCII mathematics, parsed, and as LaTeX
search     entries by id, equation number or words
"""
