"""A headless Chromium for tests of pages; tests skip where none is installed."""
from __future__ import annotations

import shutil
import time
from pathlib import Path

import pytest

FLAGS = ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars")
SIZES = {"laptop": (1280, 800), "phone": (390, 844)}
PATIENCE = 120.0        # seconds: WebGL is done in software


def start(folder: Path, device: str, *flags: str):
    """A browser of that device's size, with an empty profile in `folder`."""
    chromium = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if chromium is None or shutil.which("chromedriver") is None:
        pytest.skip("pages are tested in Chromium, which is not installed (Debian: apt-get install chromium chromium-driver)")
    webdriver = pytest.importorskip("selenium.webdriver", reason="pages are tested with selenium, which is not installed")
    from selenium.webdriver.chrome.service import Service
    width, height = SIZES[device]
    options = webdriver.ChromeOptions()
    options.binary_location = chromium
    for flag in (*FLAGS, *flags, f"--user-data-dir={folder}", f"--window-size={width},{height}"):
        options.add_argument(flag)
    if device == "phone":
        metrics = {"width": width, "height": height, "pixelRatio": 2.0, "touch": True}
        options.add_experimental_option("mobileEmulation", {"deviceMetrics": metrics})
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    browser = webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))
    browser.set_script_timeout(PATIENCE)
    return browser


def show(browser, path: Path) -> None:
    """Open a page and wait until everything on it is drawn."""
    browser.get(path.as_uri())
    end = time.monotonic() + PATIENCE
    while not browser.execute_script("return document.documentElement.dataset.ready"):
        assert time.monotonic() < end, f"{path.name} was not drawn in {PATIENCE} s: {errors(browser)}"
        time.sleep(0.2)


def errors(browser) -> list[str]:
    """What the page complained about since the last look."""
    return [e["message"] for e in browser.get_log("browser") if e["level"] == "SEVERE" or "GL Driver Message" not in e["message"]]
