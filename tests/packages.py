"""Packages of strangers, as pip leaves them: a folder of metadata beside their modules."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path

Groups = Mapping[str, Mapping[str, str]]


def install(site: Path, name: str, groups: Groups, version: str = "1.0") -> Path:
    """Write a package's name and its entry points, by group, into a folder on the path; returns that folder."""
    info = site / f"{name.replace('-', '_')}-{version}.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
    lines = (
        "\n".join([f"[{group}]", *(f"{entry} = {target}" for entry, target in entries.items())])
        for group, entries in groups.items()
    )
    (info / "entry_points.txt").write_text("\n".join(lines) + "\n")
    return site


def install_example(example: Path, site: Path) -> Path:
    """Do that for a folder with a pyproject.toml; its modules stay where they are."""
    project = tomllib.loads((example / "pyproject.toml").read_text())["project"]
    return install(site, project["name"], project["entry-points"], project["version"])
