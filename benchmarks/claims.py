"""Write the table of docs/paper_claims.md from references/paper_claims.yaml: `python benchmarks/claims.py`."""

from __future__ import annotations

import re
from pathlib import Path

from benchbench.report.claims import load, markdown

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "paper_claims.md"
TABLE = re.compile(r"^\| claim \|.*?\n(?=\n)", re.MULTILINE | re.DOTALL)


def main() -> int:
    """Replace the table."""
    table = markdown(load(ROOT / "references" / "paper_claims.yaml"))
    text, count = TABLE.subn(lambda _: table, PAGE.read_text("utf-8"))
    if count != 1:
        raise SystemExit(f"{PAGE}: {count} tables of claims")
    PAGE.write_text(text, "utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
