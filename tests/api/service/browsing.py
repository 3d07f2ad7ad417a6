"""A browser at the page of a running service: Debian's Chromium, as people have it."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import urlsplit

from playwright.sync_api import Browser, BrowserContext, Page, sync_playwright

from tests.api.command import running, wait_for_line

CHROMIUM = shutil.which("chromium")
# Root has no sandbox, and nothing that the browser does by itself may look like the page's doing.
ARGUMENTS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
WAIT_MS = 120_000
SMALL = ("96", "64")
"""Pixels that are measured in seconds."""
# The browser notes by itself that an answer was a refusal or did not come.
NOTED = "Failed to load resource"
LISTEN = """addEventListener("securitypolicyviolation", (one) => {
  console.error(`policy: ${one.violatedDirective} ${one.blockedURI}`);
});"""


@dataclass
class Visit:
    """A page, and what went on behind it."""

    page: Page
    url: str
    complaints: list[str] = field(default_factory=list)
    hosts: set[str] = field(default_factory=set)

    def level(self, *paths: Path) -> None:
        """Chooses files in the page's file field."""
        self.page.set_input_files("#files", [str(path) for path in paths])

    def techniques(self) -> list[str]:
        """What the table says to use, light by light."""
        return self.page.locator("tr.predicted .name").all_inner_texts()


@contextmanager
def served(*arguments: object, **more: str) -> Iterator[str]:
    """A service on a free port; gives its address."""
    with running("serve", "--quiet", "--port", 0, *arguments, **more) as process:
        line = wait_for_line(process, "Gnomon is at")
        found = re.search(r"http://\S+", line)
        assert found
        yield found.group().rstrip("/")


@contextmanager
def browser() -> Iterator[Browser]:
    """Chromium, without a window."""
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=CHROMIUM, args=list(ARGUMENTS))
        try:
            yield opened
        finally:
            opened.close()


def visit(context: BrowserContext, url: str, fragment: str = "") -> Visit:
    """Opens the page, and listens to whatever it does."""
    page = context.new_page()
    page.set_default_timeout(WAIT_MS)
    page.add_init_script(LISTEN)
    found = Visit(page, url)
    page.on(
        "console",
        lambda one: (
            found.complaints.append(one.text)
            if one.type in ("error", "warning") and NOTED not in one.text
            else None
        ),
    )
    page.on("pageerror", lambda one: found.complaints.append(str(one)))
    page.on(
        "request",
        lambda one: found.hosts.add(urlsplit(one.url).netloc) if one.url.startswith("http") else None,
    )
    page.goto(f"{url}/{fragment}")
    page.wait_for_selector("body:not(.starting)")
    return found


def open_level(found: Visit, *paths: Path) -> None:
    found.level(*paths)
    found.page.wait_for_selector(".lights tbody")


def small(found: Visit) -> None:
    """Asks for few pixels, so that measuring takes seconds."""
    found.page.select_option("#resolution", "")
    for name, value in zip(("width", "height"), SMALL, strict=True):
        found.page.fill(f"#{name}", value)
    found.page.wait_for_function("() => document.getElementById('level-facts').textContent.includes('96x64')")
