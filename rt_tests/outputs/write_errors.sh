#!/usr/bin/env bash
# write_errors.sh PROGRAMS SHIM STRIDE: the n-th write of a command fails, for every STRIDE-th n until a run has fewer; as
# on a disk that is full from then on, or once. Each run ends in an error or in the whole result, never in another.
set -uo pipefail
here=$(cd "$(dirname "$0")" && pwd)
source "$here/scene.sh"
PATH=$(cd "$1" && pwd):$PATH
shim=$(realpath "$2")
stride=$3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
injected=0 errors=0 whole=0

# inject RESULT REFERENCE PREPARE COMMAND...: PREPARE is run before each
inject() {
  local result=$1 reference=$2 prepare=$3 at=1 status before
  shift 3
  while :; do
    for on in 0 1; do
      $prepare
      rm -f note
      before=none
      [ -e "$result" ] && before=$(cksum <"$result")
      FAIL_AT=$at FAIL_ON=$on FAIL_CLOSE=$((at % 2)) FAIL_NOTE=$folder/note LD_PRELOAD=$shim "$@" >out 2>err
      status=$?
      [ -e note ] || return 0
      injected=$((injected + 1))
      if [ $status -eq 0 ]; then
        whole=$((whole + 1))
        same "$result" "$reference" "write $at of '$*' failed, and it said nothing"
      elif [ $status -eq 1 ]; then
        errors=$((errors + 1))
        [ -s err ] || fail "write $at of '$*' failed without a word"
        if [ -e "$result" ] && [ "$(cksum <"$result")" != "$before" ]; then
          same "$result" "$reference" "write $at of '$*' failed and left"
        fi
      else
        fail "write $at of '$*' failed: exit status $status"
      fi
      nothing_left "write $at of '$*'"
      if [ "${1-} ${2-}" = "greenloop build" ]; then
        expect 0 "after write $at of '$*' failed" "$@"
        same "$result" "$reference" "after write $at of '$*' failed"
      fi
    done
    at=$((at + stride))
  done
}

cube . 1
greenloop build cube.toml -o reference.gloop >/dev/null 2>&1 || fail "no reference"
for name in reference.gloopz reference.off reference.h; do greenloop convert reference.gloop -o $name >/dev/null; done
cp reference.gloop named.gloop
greenloop report named.gloop -o reference.html >/dev/null || fail "no reference of the report"
greenloop-loop reference.gloop --seconds 0.3 --transport memq --trace reference.csv >/dev/null || fail "no reference of the run"

afresh() { rm -f c.*; }
stale() {  # another body's model is there, and a store without it
  cp reference.gloopz c.gloop
  rm -f c.h5
}
old() {
  for name in o.gloopz o.off o.c o.h o.html o.csv; do
    rm -f $name
    printf 'old' >$name
  done
  rm -f o.c o.h
}
inject c.gloop reference.gloop afresh greenloop build cube.toml -o c.gloop
inject c.gloop reference.gloop stale greenloop build cube.toml -o c.gloop
inject o.gloopz reference.gloopz old greenloop convert reference.gloop -o o.gloopz
inject o.off reference.off old greenloop convert reference.gloop -o o.off
inject o.html reference.html old greenloop report named.gloop -o o.html
inject o.csv reference.csv old greenloop-loop reference.gloop --seconds 0.3 --transport memq --trace o.csv
printf '%s write errors: %s ended in an error, %s in the whole result\n' "$injected" "$errors" "$whole"
[ "$injected" -gt 0 ] || fail "nothing was injected"
finish
