"""A real browser without a window, to look at pages as a person would."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.remote.webdriver import WebDriver

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
ARGUMENTS = (
    "--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--enable-unsafe-swiftshader", "--hide-scrollbars",
)  # fmt: skip


@contextmanager
def browser(width: int, height: int = 1000) -> Iterator[WebDriver]:
    """Start the Chromium of this machine; skips the test where there is none."""
    program, driver = next(filter(None, map(shutil.which, NAMES)), None), shutil.which("chromedriver")
    if program is None or driver is None:
        pytest.skip(
            "no Chromium with its chromedriver here (Debian, Ubuntu: apt-get install chromium chromium-driver)"
        )
    options = Options()
    options.binary_location = program
    for argument in ARGUMENTS:
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    page = webdriver.Chrome(options=options, service=Service(driver))
    try:
        resize(page, width, height)
        yield page
    finally:
        page.quit()


def resize(page: WebDriver, width: int, height: int = 1000) -> None:
    """Make the page as wide as a desk's or a telephone's."""
    size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
    page.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)


def errors(page: WebDriver) -> list[dict[str, Any]]:
    """What the console has called an error since it was last asked."""
    return [entry for entry in page.get_log("browser") if entry["level"] == "SEVERE"]


def address(path: Path) -> str:
    return path.resolve().as_uri()
