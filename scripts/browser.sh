#!/bin/sh
# The report's tests need a Chromium. Where there is none: as root on Debian installs it, elsewhere
# says in one line how to get it. Never fails: without a browser those tests say that they were not run.
set -u
for name in chromium chromium-browser google-chrome google-chrome-stable; do
    command -v "$name" >/dev/null && exit 0
done
ls "${PLAYWRIGHT_BROWSERS_PATH:-$HOME/.cache/ms-playwright}"/chromium*/ >/dev/null 2>&1 && exit 0

# Ubuntu's package is a snap, which does not start in containers.
if command -v apt-get >/dev/null && [ "$(id -u)" = 0 ] && grep -q '^ID=debian' /etc/os-release 2>/dev/null; then
    echo "Installing Chromium for the tests of the report"
    export DEBIAN_FRONTEND=noninteractive
    log=$(mktemp)
    { apt-get update -q && apt-get install -y -q --no-install-recommends chromium; } \
        </dev/null >"$log" 2>&1 || tail -n 3 "$log" >&2
    rm -f "$log"
    command -v chromium >/dev/null && exit 0
fi
echo "The report will not be tried in a browser: no Chromium (apt-get install chromium, or" \
    "playwright install chromium)" >&2
exit 0
