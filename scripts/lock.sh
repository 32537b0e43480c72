#!/bin/sh
# Resolves requirements.lock: every platform, Python >= 3.11, hashes, no address of a registry.
# Usage: scripts/lock.sh [--upgrade]   PYTHON=... chooses the interpreter of the tool's environment
set -eu
cd "$(dirname "$0")/.."
tools=build/lock
[ -x $tools/bin/uv ] || {
    "${PYTHON:-python3}" -m venv $tools
    $tools/bin/python -m pip install --quiet --disable-pip-version-check 'uv>=0.9'
}
UV_CUSTOM_COMPILE_COMMAND='make lock' $tools/bin/uv pip compile --quiet --universal --python-version 3.11 \
    --generate-hashes --no-emit-index-url --no-emit-find-links --no-header \
    --extra dev "$@" --output-file requirements.lock pyproject.toml
