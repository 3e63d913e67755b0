#!/usr/bin/env bash
# programs.sh PROGRAMS CMAKE: every program greenloop* there, and every command of greenloop, has --help, --version and
# --json, one version, one set of exit statuses, one word for a verdict, and prints UTF-8 without control bytes.
set -uo pipefail
here=$(cd "$(dirname "$0")" && pwd)
source "$here/scene.sh"
programs=$(cd "$1" && pwd)
cmake=$2
PATH=$programs:$PATH
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1

legible() {  # legible WHAT: what was printed
  LC_ALL=C grep -qP '[\x00-\x08\x0b-\x1f\x7f]|\xc2[\x80-\x9f]' out err && fail "$1 prints control bytes"
  cat out err | iconv -f UTF-8 -t UTF-8 >/dev/null 2>&1 || fail "$1 prints what is not UTF-8"
}
json() {  # json STATUS VERDICT|- COMMAND...: its output is an object, with that verdict
  local status=$1 verdict=$2
  shift 2
  expect "$status" "$*" "$@"
  legible "$*"
  local checks=(-DFILE=out)
  [ "$verdict" = - ] || checks+=("-DVERDICT=$verdict")
  grep -q '"digest"' out && checks+=(-DDIGEST=1)
  "$cmake" "${checks[@]}" -P "$here/is_json.cmake" 2>message || fail "$*: $(tr '\n' ' ' <message)"
}
usage() {  # usage COMMAND...: what every program and command has
  expect 0 "$* --help" "$@" --help
  legible "$* --help"
  [ "$1" = greenloop ] && [ $# -eq 1 ] || grep -q -- --json out || fail "$* has no --json"
  expect 0 "$* --version" "$@" --version
  same out version "the version of $*"
  expect 2 "$* with an unknown option" "$@" --no-such-option
  [ -s err ] || fail "$* with an unknown option says nothing"
  legible "$* with an unknown option"
  [ $# -gt 1 ] || expect 2 "$* without arguments" "$@"
}

greenloop --version >version || fail "greenloop --version"
grep -qE '^greenloop [0-9]+\.[0-9]+\.[0-9]+$' version || fail "the version is $(cat version)"
found=0
for program in "$programs"/greenloop*; do
  [ -x "$program" ] || continue
  usage "$(basename "$program")"
  found=$((found + 1))
done
[ "$found" -ge 8 ] || fail "only $found programs"
for command in build inspect verify convert report; do usage greenloop $command; done

cube . 1
json 0 HELD greenloop build cube.toml -o c.gloop --json
json 0 HELD greenloop inspect c.gloop --json
json 0 HELD greenloop verify c.gloop --json
json 0 - greenloop convert c.gloop -o c.gloopz --json
json 0 - greenloop report c.gloop --json
json 0 HELD greenloop-loop c.gloop --seconds 0.2 --transport memq --json
json 0 HELD greenloop-stress c.gloop --cycles 200 --json
json 0 - greenloop-calibrate c.gloop --cycles 200 --json
json 0 - greenloop-bench c.gloop --store c.h5 --contacts 1 --rounds 3 --updates 10 --json
json 0 - greenloop-bench --multigrid --cells 4 --netgen-cells 0 --json
json 0 - greenloop-figures c.h5 --contacts 1 --rounds 3 --json
json 0 - greenloop-columns cube.toml --records c.csv --json
json 0 - greenloop-masks 1 --sliding-splits 1 --points 8 --json
json 1 VIOLATED greenloop-stress c.gloop --cycles 2000 --inject overrun --json
printf 'junk' >junk.gloop
json 1 VIOLATED greenloop verify junk.gloop --json
expect 0 "inspect" greenloop inspect c.gloop
grep -q '"scene_text"' out && fail "inspect prints provenance unasked"
grep -q 'compression error' out && grep -q 'mesh error' out || fail "inspect does not tell both errors"
expect 0 "inspect --provenance" greenloop inspect c.gloop --provenance
grep -q '"scene_text"' out || fail "inspect --provenance does not print it"
finish
