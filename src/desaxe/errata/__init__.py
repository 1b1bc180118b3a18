"""The ledgers of the papers' errata, one TOML file a paper; `desaxe._errata` reads them."""
