"""Pages in a real browser, Chromium without a window: how they are laid out, in one start for all of them."""

import json
import shutil
import subprocess
from collections.abc import Mapping
from html import escape
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

#: A phone's width, the same in dark, and a desktop's: width in pixels and colour scheme.
SCREENS = {"phone": (375, "light"), "dark": (375, "dark"), "desktop": (1280, "light")}

_FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-3d-apis", "--disable-quic", "--disable-dev-shm-usage",
    "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--hide-scrollbars",
)  # fmt: skip

#: Runs outside the pages, which run nothing themselves.
_MEASURE = """
const light = ([r, g, b]) => [r, g, b].map(v => v / 255)
  .map(v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
  .reduce((sum, v, k) => sum + v * [0.2126, 0.7152, 0.0722][k], 0);
const rgb = text => text.match(/[\\d.]+/g).map(Number);
const ground = element => {
  for (let one = element; one; one = one.parentElement) {
    const colour = rgb(getComputedStyle(one).backgroundColor);
    if (colour.length < 4 || colour[3] > 0) return colour;
  }
  return [255, 255, 255];
};
const measure = frame => {
  const page = frame.contentDocument, root = page.documentElement, view = frame.contentWindow;
  page.querySelectorAll("details").forEach(one => one.open = true);
  const wide = [], low = [], cut = [];
  for (const one of page.querySelectorAll("body *")) {
    const box = one.getBoundingClientRect(), style = view.getComputedStyle(one);
    const scrolls = one.closest(".scroll") && !one.matches(".scroll");
    const hidden = style.position === "absolute" || one.closest("thead")?.offsetWidth === 1;
    if (!scrolls && !hidden && (box.right > root.clientWidth + 0.5 || box.left < -0.5)) wide.push(one.outerHTML);
    const words = [...one.childNodes].some(node => node.nodeType === 3 && node.data.trim());
    if (words && one.tagName !== "title") {
      const ink = rgb(one.matches("svg text") ? style.fill : style.color);
      const pair = [light(ink), light(ground(one))].sort((a, b) => b - a);
      if ((pair[0] + 0.05) / (pair[1] + 0.05) < 4.5) low.push(one.outerHTML);
    }
    if (one.matches("svg text")) {
      const edge = one.ownerSVGElement.getBoundingClientRect();
      if (box.left < edge.left - 1 || box.right > edge.right + 1 || box.top < edge.top - 1) cut.push(one.textContent);
    }
  }
  return {
    client: root.clientWidth, scroll: root.scrollWidth, wide, low, cut,
    scrolling: [...page.querySelectorAll(".scroll")].filter(one => one.scrollWidth > one.clientWidth).length,
    pictures: [...page.images].map(one => one.naturalWidth),
    ground: light(ground(page.body)), ran: !!view.ran || !!window.ran, heading: page.querySelector("h1").textContent,
    loaded: view.performance.getEntriesByType("resource").map(one => one.name).filter(one => !one.startsWith("data:")),
  };
};
addEventListener("load", () => {
  const found = Object.fromEntries([...document.querySelectorAll("iframe")].map(one => [one.title, measure(one)]));
  document.getElementById("found").textContent = JSON.stringify(found);
});
"""


def laid_out(pages: Mapping[str, str], folder: Path) -> dict[tuple[str, str], dict[str, Any]]:
    """What each page measures on each of :data:`SCREENS`, everything unfolded."""
    frames = "".join(
        f'<iframe title="{name} {screen}" style="width:{width}px;height:600px;border:0;color-scheme:{scheme}" '
        f'srcdoc="{escape(page)}"></iframe>'
        for name, page in pages.items()
        for screen, (width, scheme) in SCREENS.items()
    )
    sheet = folder / "sheet.html"
    sheet.write_text(
        f'<!DOCTYPE html><meta charset="utf-8"><pre id="found"></pre>{frames}<script>{_MEASURE}</script>',
        encoding="utf-8",
    )
    chromium = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    assert chromium, "no Chromium; `make test` installs it"
    command = [chromium, *_FLAGS, f"--user-data-dir={folder / 'profile'}", "--dump-dom", sheet.as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    found = json.loads(_Found(done.stdout).text)
    return {tuple(key.split(" ")): value for key, value in found.items()}


class _Found(HTMLParser):
    """Text of the first ``pre``."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.text, self._inside = "", False
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._inside = tag == "pre"

    def handle_endtag(self, tag: str) -> None:
        self._inside = False

    def handle_data(self, data: str) -> None:
        self.text += data * self._inside
