#!/bin/sh
# Creates .venv if it is missing or broken and installs the locked dependencies and this package.
# Usage: scripts/setup_venv.sh STAMP   (the stamp is written last; it holds the folder it is valid for)
# PYTHON=... chooses the interpreter; otherwise the first one that is new enough is taken.
set -eu
cd "$(dirname "$0")/.."
stamp=$1
venv=.venv
unfinished=$venv/unfinished # there while an installation runs: an interrupted one is not built upon

# Snakemake runs scripts by the interpreter's path, unquoted.
case $(pwd -P) in *[[:space:]]*)
    echo "error: Snakemake cannot run from a path with spaces: $(pwd -P); move or rename the folder" >&2
    exit 1
    ;;
esac

# Prints the base interpreter of $1 if that is Python >= 3.11 and able to make environments.
base_interpreter() {
    "$1" -c '
import ensurepip, sys, venv
if sys.version_info < (3, 11):
    raise SystemExit(1)
print(getattr(sys, "_base_executable", None) or sys.executable)' 2>/dev/null
}

find_interpreter() {
    if [ -n "${PYTHON:-}" ]; then
        base_interpreter "$PYTHON" && return
        echo "error: PYTHON=$PYTHON is not a Python >= 3.11 with the modules venv and ensurepip" >&2
        return 1
    fi
    for name in python3 python3.13 python3.12 python3.11 python3.14 python; do
        base_interpreter "$name" && return
    done
    echo "error: no Python >= 3.11 with venv and ensurepip found (Debian, Ubuntu: package python3-venv); name one with make PYTHON=..." >&2
    return 1
}

usable() {
    [ ! -e "$unfinished" ] && [ -x $venv/bin/python ] &&
        $venv/bin/python -c 'import sys; raise SystemExit(sys.version_info < (3, 11))' 2>/dev/null &&
        $venv/bin/python -m pip --version >/dev/null 2>&1
}

if ! usable; then
    interpreter=$(find_interpreter)
    echo "Creating $venv with $("$interpreter" --version)"
    rm -rf $venv
    mkdir $venv
    touch $unfinished
    "$interpreter" -m venv $venv
fi
touch $unfinished
rm -f "$stamp"
pip="$venv/bin/python -m pip --disable-pip-version-check --no-input"
echo "Installing the locked dependencies into $venv (1.4 GB, a minute or two the first time)"
$pip install --quiet --quiet --require-hashes -r requirements.lock
$pip install --quiet --quiet --no-deps --no-build-isolation -e .
rm -f $unfinished
pwd -P >"$stamp"
