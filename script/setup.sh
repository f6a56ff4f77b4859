# Sourced by script/demo and script/test: finds or installs what they need.
# After it: $PYTHON is the interpreter of the project's own virtual environment, $ROS is yes or no.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

ROS_PACKAGES="python3-rospy python3-roslaunch python3-rostopic python3-rosnode rosout python3-std-msgs
  python3-diagnostic-msgs python3-numpy ros-environment catkin catkin-tools cmake make g++
  ros-message-generation ros-message-runtime ros-std-msgs libstd-msgs-dev libdiagnostic-msgs-dev
  rosbash catkin-lint python3-sensor-msgs iproute2 nftables libfastrtps-dev
  prometheus"
# What ROS 2 from PyPI (script/ros2.sh) needs to compile messages, and ament's linters.
ROS2_PACKAGES="python3-venv python3-dev cmake make g++
  python3-ament-flake8 python3-ament-pep257 python3-ament-lint-cmake python3-ament-xmllint"

have_ros() {
  local name
  for name in roscore roslaunch rostopic rosnode catkin_make catkin catkin_lint cmake g++ ip nft promtool; do
    command -v "$name" >/dev/null || return 1
  done
  [ -d /usr/include/fastdds ] || return 1
  /usr/bin/python3 -c 'import rospy, std_msgs.msg, diagnostic_msgs.msg, sensor_msgs.msg, numpy' 2>/dev/null
}

have_for_ros2() {
  command -v ament_flake8 >/dev/null && command -v cmake >/dev/null && command -v g++ >/dev/null &&
    ls /usr/include/python3.*/Python.h >/dev/null 2>&1
}

apt_install() { # as root on a Debian system; anything else says so and goes on without
  if [ "$(id -u)" != 0 ] || ! command -v apt-get >/dev/null; then return 1; fi
  echo "installing Debian packages: $(echo $* | cut -c1-60)..." >&2
  apt-get update -qq >/dev/null 2>&1 || true
  DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@" >/dev/null 2>&1
}

usable() { "$1" -c 'import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 10))' 2>/dev/null; }

find_python() {
  local name
  for name in python3 python3.13 python3.12 python3.11 python3.10 /usr/bin/python3; do
    if command -v "$name" >/dev/null && usable "$name"; then command -v "$name"; return; fi
  done
  return 1
}

command -v git >/dev/null || apt_install git || { echo "git is missing: apt-get install git" >&2; exit 2; }
BASE_PYTHON=$(find_python) || { apt_install python3 python3-venv && BASE_PYTHON=$(find_python); } ||
  { echo "Python 3.10 or newer with venv is missing: apt-get install python3 python3-venv" >&2; exit 2; }

if have_ros || { [ "${FAST:-no}" = no ] && apt_install $ROS_PACKAGES && have_ros; }; then ROS=yes; else ROS=no; fi
STAMP=.venv/.installed-from
WANTED="$(cat pyproject.toml) $BASE_PYTHON $PWD"
if [ ! -x .venv/bin/python ] || [ "$(cat "$STAMP" 2>/dev/null)" != "$WANTED" ]; then
  echo "installing eddi-scaffold into .venv ..." >&2
  "$BASE_PYTHON" -m venv --clear .venv
  # uv takes a tenth of pip's time; pip knows what this machine says about indexes.
  .venv/bin/python -m pip install --quiet --disable-pip-version-check uv 2>/dev/null &&
    .venv/bin/uv pip install --quiet --python .venv --editable ".[${EXTRAS:-dev}]" 2>/dev/null ||
    .venv/bin/python -m pip install --no-compile --quiet --disable-pip-version-check --editable ".[${EXTRAS:-dev}]"
  printf '%s' "$WANTED" >"$STAMP"
fi
PYTHON=$PWD/.venv/bin/python

if [ "${ROS2:-no}" = yes ]; then # a demo does without
  have_for_ros2 || apt_install $ROS2_PACKAGES || true
  script/ros2.sh kilted >/dev/null || [ $? != 1 ] || export EDDI_NO_ROS2=1 # it has said why
fi
