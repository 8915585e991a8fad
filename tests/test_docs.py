"""The docs: each page begins with the question it answers, the index has them all, and links lead somewhere."""

from __future__ import annotations

import pkgutil
import re
from pathlib import Path

import pytest

from benchbench.ground import registry

ROOT = Path(__file__).resolve().parents[1]
PAGES = sorted((ROOT / "docs").glob("*.md"))
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
FOLDERS = ("", "benchbench", "plugins/benchbench_plugins")
"""Where paths in the text begin; the rooms are in the second."""
FILE = re.compile(r"`((?:[a-z_]+/)+[\w.]+\.(?:py|yaml|html|ipynb|svg))(?::\d+)?`")
EXAMPLES = ("conf/__init__.py",)
"""Files of the reader's own."""
MODULE = re.compile(r"`((?:benchbench|benchbench_plugins)(?:\.[a-z_0-9]+)+)\b")
GROUPS = {f"benchbench.{group}" for group in (*registry.FAMILIES, *registry.PARTS, "conf", "checks")}
CODE = re.compile(r"```.*?```|`[^`\n]*`", re.DOTALL)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_begins_with_its_question(page: Path) -> None:
    first = page.read_text("utf-8").partition("\n")[0]
    assert first.startswith("# ") and "?" in first


def test_the_index_has_every_page() -> None:
    index = (ROOT / "docs" / "README.md").read_text("utf-8")
    linked = {link.partition("#")[0] for link in LINK.findall(index)}
    assert {page.name for page in PAGES} - {"README.md"} <= linked


EVERY = pytest.mark.parametrize(
    "page", [*PAGES, *(ROOT / f"{name}.md" for name in ("README", "ARCHITECTURE", "CONTRIBUTING"))], ids=lambda page: page.stem
)  # fmt: skip


@EVERY
def test_links_lead_somewhere(page: Path) -> None:
    """Files are there, and so are the headings within them."""
    for link in LINK.findall(CODE.sub("", page.read_text("utf-8"))):
        path, _, heading = link.partition("#")
        if "://" in path:
            continue
        target = (page.parent / path).resolve() if path else page
        assert target.exists(), f"{page.name}: {link}"
        if heading and target.suffix == ".md":
            assert heading in headings(target), f"{page.name}: {link}"


@EVERY
def test_files_and_modules_that_it_names_are_there(page: Path) -> None:
    text = page.read_text("utf-8")
    for path in FILE.findall(text):
        ours = any((ROOT / folder / path.partition("/")[0]).is_dir() for folder in FOLDERS)
        found = any((ROOT / folder / path).exists() for folder in FOLDERS)
        assert found or not ours or "NAME" in path or path in EXAMPLES, path
    for name in set(MODULE.findall(text)) - GROUPS:
        pkgutil.resolve_name(name)


def headings(page: Path) -> set[str]:
    """What they are called in a link, as GitHub does it."""
    lines = re.findall(r"^#+ (.*)$", page.read_text("utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", line.lower()).replace(" ", "-") for line in lines}
