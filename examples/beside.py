"""What the ledgers say of a paper, for its notebook: `beside("A-eq19")` shows the entry under a figure."""

from desaxe.tests.papers.errata.ledger import entries


class Beside:
    """Entries of the ledgers, as text or as Markdown in a notebook."""

    def __init__(self, *ids):
        every = {entry.id: entry for entry in entries()}
        self.entries = [every[one] for one in ids]

    def __repr__(self):
        return "\n\n".join(
            f"{e.id}: {e.verdict}\n{e.printed}\n{e.corrected}\n{e.evidence}" for e in self.entries
        )

    def _repr_markdown_(self):
        return "\n\n".join(map(_markdown, self.entries))


def _markdown(entry):
    lines = [f"**{entry.verdict}** ({entry.id}, {entry.where})", f"- printed: `{entry.printed}`"]
    lines += [f"- instead: `{entry.corrected}`"] if entry.corrected else []
    return "\n".join([lines[0], "", *lines[1:], f"- because: {entry.evidence}"])


beside = Beside
