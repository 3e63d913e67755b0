#!/usr/bin/env bash
# horse.sh PROGRAMS EXAMPLES C_DRAG: the horse of the examples, built, inspected, dragged by a device in a process of its
# own and by the example in C, stressed and reported.
set -euo pipefail
programs=$1 examples=$2 c_drag=$3
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
cd "$folder"
cp "$examples/horse.toml" .
"$programs/write_animal" 1 horse.off
"$programs/greenloop" build horse.toml -o horse.gloop >/dev/null 2>&1
"$programs/greenloop" inspect horse.gloop --json >inspect.json
"$programs/greenloop-loop" horse.gloop --script drag --seconds 2 --trace trace.csv --snapshot snapshot.csv --json >drag.json
"$programs/greenloop-loop" horse.gloop --script drag --seconds 2 --transport memq --json >memory.json
"$programs/greenloop-stress" horse.gloop --cycles 600 --json >stress.json 2>/dev/null
"$programs/greenloop" report horse.gloop --trace trace.csv --snapshot snapshot.csv -o horse.html --figures figures >/dev/null

"$c_drag" horse.gloop >/dev/null

value() { grep -m 1 "\"$2\":" "$1" | sed -E 's/.*: "?([^",]*)"?,?$/\1/'; }
expect() {  # expect FILE KEY VALUE
  test "$(value "$1" "$2")" = "$3" || { echo "$1: $2 is $(value "$1" "$2"), not $3"; exit 1; }
}
expect inspect.json kind multigrid
test "$(value inspect.json cycles)" -ge 1
expect drag.json verdict HELD
expect drag.json cycles 2000
expect drag.json allocations 0
expect drag.json grasps 1
expect memory.json digest "$(value drag.json digest)"
expect stress.json verdict HELD
test "$(wc -l <trace.csv)" -eq 2001
for figure in materials sag dragged convergence force displacement bytes; do test -s "figures/$figure.svg"; done
if "$programs/greenloop-loop" horse.gloop 2>refusal.txt; then exit 1; fi
grep -q -- '--script drag' refusal.txt
