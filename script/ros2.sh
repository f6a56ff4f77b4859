#!/usr/bin/env bash
# Install ROS 2 from the wheels of PyPI, once for each list of them: script/ros2.sh kilted|jazzy
# The last line that it prints is the folder, which is a virtual environment and ament's prefix in one.
# Where it does not fit it says why and ends with status 1; status 2: it should, and could not be installed.
set -euo pipefail
HERE=$(dirname "${BASH_SOURCE[0]}")
case "$1" in
  kilted) PYTHONS="/usr/bin/python3.11 python3.11 python3.13" ;;
  jazzy) PYTHONS="python3.12" ;;
esac
refuse() { echo "ROS 2 $1 is not here: $2" >&2; exit 1; }

[ "$(uname -sm)" = "Linux x86_64" ] || refuse "$1" "its wheels are for Linux on x86_64"
PYTHON=""
for name in $PYTHONS "$HOME"/.pyenv/versions/3.12.*/bin/python; do
  version=$("$name" -c 'import sys, ensurepip, venv; print("%d.%d" % sys.version_info[:2])' 2>/dev/null) || continue
  case "$PYTHONS" in *"python$version"*) PYTHON=$name; break ;; esac
done
[ -n "$PYTHON" ] || refuse "$1" "it needs one of $PYTHONS, with venv"
include=$("$PYTHON" -c 'import sysconfig; print(sysconfig.get_path("include"))')
[ -f "$include/Python.h" ] || refuse "$1" "messages are compiled with $include/Python.h: apt-get install python3-dev"

LIST=$HERE/ros2_wheels.txt
PLACE=${XDG_CACHE_HOME:-$HOME/.cache}/eddi-scaffold/ros2-$1-$(sha256sum "$LIST" | cut -c1-12)
mkdir -p "$(dirname "$PLACE")"
exec 9>"$PLACE.lock"
flock 9 # another run may be installing it
if [ ! -f "$PLACE/.complete" ]; then
  echo "installing ROS 2 $1 into $PLACE ..." >&2
  "$PYTHON" -m venv --clear "$PLACE"
  "$HERE/../.venv/bin/uv" pip install --quiet --python "$PLACE/bin/python" --requirement "$LIST" 2>/dev/null ||
    "$PLACE/bin/python" -m pip install --no-compile --quiet --disable-pip-version-check --requirement "$LIST" 2>"$PLACE/pip.log" ||
    { echo "ROS 2 $1: $(grep ERROR "$PLACE/pip.log" | tail -n 1)" >&2; exit 2; }
  "$PLACE/bin/python" -m compileall -q -j 2 -x '/tests?/' "$PLACE/lib" || true # by who may not write it
  # The wheels name two folders of the machine on which they were made.
  numpy=$("$PLACE/bin/python" -c 'import numpy; print(numpy.get_include())')
  find "$PLACE/share" -name '*.cmake' -exec sed -i -E \
    -e "s|/opt/python/cp[0-9]+-cp[0-9]+/include/python3\.[0-9]+|$include|g" \
    -e "s|/opt/python/cp[0-9]+-cp[0-9]+/lib/python3\.[0-9]+/site-packages/numpy/_core/include|$numpy|g" {} +
  touch "$PLACE/.complete"
fi
echo "$PLACE"
