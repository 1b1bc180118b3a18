"""The ledgers of the papers' errata, one TOML file a paper; `desaxe.errata.ledger` reads them."""
