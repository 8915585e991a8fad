"""Where a study is kept: a database URL, or journal:FILE."""

from __future__ import annotations

from pathlib import Path

from optuna.storages import JournalStorage
from optuna.storages.journal import JournalFileBackend

JOURNAL, SQLITE = "journal:", "sqlite:///"


def opened(storage: str) -> str | JournalStorage:
    """Return what Optuna takes; the folder of a file is made."""
    for prefix in (JOURNAL, SQLITE):
        if storage.startswith(prefix):
            Path(storage.removeprefix(prefix)).parent.mkdir(parents=True, exist_ok=True)
    if storage.startswith(JOURNAL):
        return JournalStorage(JournalFileBackend(storage.removeprefix(JOURNAL)))
    return storage
