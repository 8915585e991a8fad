"""The columns of the table in words, for people; docs/table.md is this text."""

from __future__ import annotations

from benchbench.storage.schema import COLUMNS, SCHEMA_VERSION

_HEAD = f"""# What does each column of the table mean?

One row per run, schema version {SCHEMA_VERSION}. A cell is empty where a number does not exist or is not known: a run
that crashed has no travel time. `benchbench table --describe` prints this page.

| column | type | unit | meaning |
|---|---|---|---|
"""


def describe() -> str:
    """Return a Markdown page with one line per column: name, type, unit, meaning."""
    lines = (
        f"| `{c.name}` | {c.type} | {c.unit} | {c.meaning.replace('|', chr(92) + '|')} |" for c in COLUMNS
    )
    return _HEAD + "\n".join(lines) + "\n"
