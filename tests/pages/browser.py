# SPDX-License-Identifier: BSD-3-Clause
"""Headless Chromium, drawing in software, without a network."""

import os
import shutil
import tempfile
import time
import unittest
from pathlib import Path

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.remote.remote_connection import RemoteConnection

ROOT = Path(__file__).resolve().parents[2]
BVLAB = os.environ.get("BVLAB", str(ROOT / "build" / "release" / "bvlab"))
OPTIONS = ["--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
           "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage", "--force-device-scale-factor=1",
           "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--host-resolver-rules=MAP * ~NOTFOUND"]


# Seconds that a command may take: where a browser hangs, its test fails. Selenium would wait for ever.
PATIENCE = 240
RemoteConnection.set_timeout(PATIENCE)


def require_browser():
    """Skips the tests of a module where Chromium is installed and does not start, as in some containers."""
    try:
        Browser().driver.quit()
    except Exception as error:  # whatever stands in its way
        raise unittest.SkipTest(f"Chromium does not start here: {str(error).splitlines()[0]}") from error


class Browser:
    """Opens pages from files; `errors` are what the console held since it was asked last."""

    def __init__(self, width=1280, height=860, dark=False, more_options=()):
        options = webdriver.ChromeOptions()
        options.binary_location = os.environ.get("CHROMIUM", "/usr/bin/chromium")
        self.profile = tempfile.mkdtemp(prefix="bvlab-browser-")
        for option in [*OPTIONS, f"--user-data-dir={self.profile}", f"--window-size={width},{height}", *more_options]:
            options.add_argument(option)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        service = Service(os.environ.get("CHROMEDRIVER", "/usr/bin/chromedriver"))
        self.driver = webdriver.Chrome(service=service, options=options)
        self.driver.set_page_load_timeout(PATIENCE / 2)
        self.driver.set_script_timeout(PATIENCE / 2)
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600})
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [
            {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]})

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.driver.quit()
        except OSError:  # it hangs: its driver is ended below
            pass
        self.driver.service.stop()
        shutil.rmtree(self.profile, ignore_errors=True)

    def open(self, page):
        """Waits for the page itself: a browser that just started may still show the blank one when `get` returns."""
        address = Path(page).resolve().as_uri()
        shown = "return document.readyState === 'complete' && location.href === arguments[0]"
        for _ in range(3):
            self.driver.get(address)
            if self.wait_for(shown, 20, address):
                return
        raise AssertionError(f"{address} does not open: {self.run('return location.href')} is shown")

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def click(self, selector):
        self.driver.find_element("css selector", selector).click()

    def text(self, selector):
        return self.driver.find_element("css selector", selector).text

    def errors(self):
        return [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] == "SEVERE"]

    def wait_for(self, script, seconds=60, *arguments):
        """Until the script's value is true; says whether it came to be."""
        end = time.monotonic() + seconds
        while not (value := self.run(script, *arguments)) and time.monotonic() < end:
            time.sleep(0.05)
        return bool(value)

    def keep(self, name):
        """A picture to look at, where BVLAB_PICTURES names a folder."""
        if folder := os.environ.get("BVLAB_PICTURES"):
            Path(folder).mkdir(parents=True, exist_ok=True)
            self.driver.save_screenshot(str(Path(folder) / f"{name}.png"))
