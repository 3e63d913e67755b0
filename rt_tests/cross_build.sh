#!/usr/bin/env bash
# cross_build.sh SOURCE FOLDER CMAKE_ARGUMENT...: configures the project SOURCE in FOLDER and builds it, silently unless
# it fails.
set -euo pipefail
source=$1 folder=$2
shift 2
mkdir -p "$folder"
log=$folder/build.log
{ cmake -S "$source" -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=Release "$@" && cmake --build "$folder"; } >"$log" 2>&1 || {
  cat "$log"
  exit 1
}
