#!/usr/bin/env bash
# results.sh PROGRAMS DEMO OUT: measures the demo's model with the programs of the folder PROGRAMS, keeps what they print in OUT, and writes
# every table of docs/results.md and docs/results/ that stands between "<!-- table NAME -->" and "<!-- end -->"; tables.jq makes them.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
programs=$1 demo=$2 out=$3
model=$demo/bear.gloop
declare -A commands=(
  [inspect]="greenloop inspect $model --json"
  [bench]="greenloop-bench $model --store $demo/bear.h5 --json"
  [stress]="greenloop-stress $model --cycles 100000 --no-instructions --json"
  [loop]="greenloop-loop $model --json"
)

measure() {
  local name
  for name in inspect bench stress loop; do
    echo "results: ${commands[$name]}" >&2
    # shellcheck disable=SC2086
    "$programs"/${commands[$name]} >"$out/$name.json"
    jq --arg name "$name" --arg command "${commands[$name]}" '{commands: {($name): $command}, ($name): .}' "$out/$name.json"
  done
}

machine() {
  printf '%s processors of an %s, %s' "$(nproc)" "$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -1)" "$(c++ --version | head -1)"
}

# Prints a page with its tables made again.
filled() {
  local line name inside=
  while IFS= read -r line; do
    case $line in
      "<!-- table "*" -->")
        name=${line#<!-- table } name=${name% -->} inside=yes
        printf '%s\n\n' "$line"
        jq -r -L rt_tests/results "include \"tables\"; $name" "$out/results.json"
        echo
        ;;
      "<!-- end -->") inside= && echo "$line" ;;
      *) [ -n "$inside" ] || printf '%s\n' "$line" ;;
    esac
  done <"$1"
}

mkdir -p "$out"
measure | jq -s --arg machine "$(machine)" 'reduce .[] as $part ({machine: $machine}; . * $part)' >"$out/results.json"
for page in docs/results.md docs/results/*.md; do
  filled "$page" >"$out/page.md"
  cmp -s "$out/page.md" "$page" || cp "$out/page.md" "$page"
done
rm "$out/page.md"
