#!/bin/sh
# gmsh's wheel needs a few system libraries. Where they are missing: as root on Debian or Ubuntu
# installs them, elsewhere says in one line what to install.
# Usage: scripts/system_deps.sh [--optional | --list]
#   --optional  exit 0 even if they stay missing: only what meshes with gmsh needs them
#   --list      print the names of the packages and stop
set -u
cd "$(dirname "$0")/.." || exit 1
packages="libglu1-mesa libgl1 libxft2 libxinerama1 libxcursor1 libgomp1"
python=.venv/bin/python
mode=${1:-}

[ "$mode" = --list ] && echo "$packages" && exit 0

importable() {
    reason=$($python -c 'import gmsh' 2>&1) && return
    reason=$(printf '%s\n' "$reason" | tail -n 1)
    return 1
}

debian_like() {
    command -v apt-get >/dev/null && grep -Eq '^ID(_LIKE)?=.*(debian|ubuntu)' /etc/os-release 2>/dev/null
}

install() {
    echo "Installing the system libraries of gmsh: $packages"
    export DEBIAN_FRONTEND=noninteractive
    log=$(mktemp)
    # shellcheck disable=SC2086  # a list of packages
    { apt-get update -q && apt-get install -y -q --no-install-recommends $packages; } \
        </dev/null >"$log" 2>&1 || tail -n 3 "$log" >&2
    rm -f "$log"
}

importable && exit 0
if debian_like && [ "$(id -u)" = 0 ]; then
    install
    importable && exit 0
fi
if debian_like; then
    advice="install them as root with: apt-get install --no-install-recommends $packages"
else
    advice="install GLU, OpenGL, Xft, Xinerama, Xcursor and OpenMP (Debian's names: $packages)"
fi
echo "gmsh cannot be loaded ($reason); its meshes are not available: $advice" >&2
[ "$mode" = --optional ]
