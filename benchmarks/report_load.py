"""Size of a report, and how long Chromium takes to show it: median of several fresh starts.

Usage: python benchmarks/report_load.py [results/report.html] [repeats]
"""

import os
import shutil
import statistics
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

READ = """() => [
  performance.getEntriesByType("navigation")[0].domContentLoadedEventEnd,
  performance.getEntriesByName("figures drawn")[0].startTime,
]"""


def main() -> None:
    page_file = Path(sys.argv[1] if len(sys.argv) > 1 else "results/report.html").resolve()
    repeats = int(sys.argv[2]) if len(sys.argv) > 2 else 5
    flags = ["--disable-gpu", "--disable-background-networking"]
    flags += ["--no-sandbox"] if os.geteuid() == 0 else []
    times = []
    with sync_playwright() as playwright:
        for _ in range(repeats):
            browser = playwright.chromium.launch(
                executable_path=shutil.which("chromium"), args=flags
            )
            page = browser.new_page(viewport={"width": 1280, "height": 900})
            page.goto(page_file.as_uri())
            page.wait_for_function("document.documentElement.dataset.figures === 'drawn'")
            times.append(page.evaluate(READ))
            browser.close()
    content, drawn = (statistics.median(column) for column in zip(*times, strict=True))
    load = os.getloadavg()[0]
    print(f"{page_file.stat().st_size / 1e6:.2f} MB")
    print(f"content loaded {content:.0f} ms, all figures drawn {drawn:.0f} ms (load {load:.1f})")


if __name__ == "__main__":
    main()
