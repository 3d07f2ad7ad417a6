#!/usr/bin/env bash
# Tests the Blender extension in a real Blender without a window: the package bpy, in an environment of its own.
# The service that it talks to is the real one, from .venv. Arguments go to pytest.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

venv=.venv-blender
stamp=$venv/complete
wanted="bpy==4.5.* pytest==9.* pytest-timeout==2.*"
system_packages=(libegl1 libgl1 libice6 libsm6 libx11-6 libxfixes3 libxi6 libxkbcommon0 libxrender1 libxxf86vm1)

stop() {
    printf 'test-blender: %s\n' "$@" >&2
    exit 1
}

# bpy is built for one Python only.
find_python() {
    local candidate
    for candidate in "${PYTHON:-}" python3.11 python3; do
        if [ -n "$candidate" ] && command -v "$candidate" >/dev/null &&
            "$candidate" -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' 2>/dev/null; then
            echo "$candidate"
            return
        fi
    done
    stop "Blender 4.5 needs Python 3.11, and there is none here. Name it: make test-blender PYTHON=..."
}

[ -x .venv/bin/gnomon ] || stop "There is no .venv/bin/gnomon; run make setup first."
if [ "$(cat "$stamp" 2>/dev/null)" != "$wanted" ]; then
    python=$(find_python)
    echo "test-blender: installing $wanted into $venv (about 400 MB are loaded)"
    "$python" -m venv --clear "$venv"
    echo '*' >"$venv/.gitignore"
    # shellcheck disable=SC2086  a list
    "$venv/bin/python" -m pip install -qq --disable-pip-version-check $wanted
    echo "$wanted" >"$stamp"
fi
if ! words=$("$venv/bin/python" -c 'import bpy' 2>&1); then
    if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
        echo "test-blender: installing ${system_packages[*]} (${words##*$'\n'})"
        { apt-get update && apt-get install -y --no-install-recommends "${system_packages[@]}"; } </dev/null >/dev/null
        "$venv/bin/python" -c 'import bpy'
    else
        stop "Blender cannot be loaded. ${words##*$'\n'}" "It needs what Debian calls: ${system_packages[*]}"
    fi
fi
exec "$venv/bin/python" -m pytest -q -c plugins/blender/pytest.ini plugins/blender/tests "$@"
