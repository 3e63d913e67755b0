#!/usr/bin/env bash
# kills.sh PROGRAMS COUNT [SEED]: builds are killed at random moments COUNT times and taken up again. A model that is there
# is whole, and the bytes are always those of a build that nobody killed.
set -uo pipefail
here=$(cd "$(dirname "$0")" && pwd)
source "$here/scene.sh"
PATH=$(cd "$1" && pwd):$PATH
count=$2
RANDOM=${3:-1}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
cube . 2
begin=$(date +%s%N)
greenloop build cube.toml -o reference.gloop >/dev/null 2>&1 || fail "no reference"
milliseconds=$((($(date +%s%N) - begin) / 1000000))
kills=0 finished=0 resumed=0
while [ "$kills" -lt "$count" ]; do
  [ -e c.h5 ] && resumed=$((resumed + 1))
  greenloop build cube.toml -o c.gloop >/dev/null 2>&1 &
  build=$!
  wait=$((RANDOM * milliseconds / 24576))
  sleep $((wait / 1000)).$(printf %03d $((wait % 1000)))
  if kill -KILL $build 2>/dev/null; then kills=$((kills + 1)); fi
  wait $build 2>/dev/null
  [ -e c.gloop ] || continue
  same c.gloop reference.gloop "a build killed $kills times"
  # now and then over the model that is there
  [ $((RANDOM % 4)) -ne 0 ] && rm -f c.gloop
  rm -f c.h5 c.build.json
  finished=$((finished + 1))
done
expect 0 "after the last kill" greenloop build cube.toml -o c.gloop
same c.gloop reference.gloop "after the last kill"
rm -f c.*
expect 0 "a new build" greenloop build cube.toml -o c.gloop
nothing_left "a new build after kills"
printf '%s kills of a build of %s ms, %s of them of a resumed one: %s models came out, all the same bytes\n' \
  "$kills" "$milliseconds" "$resumed" "$finished"
finish
