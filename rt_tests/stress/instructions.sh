#!/usr/bin/env bash
# greenloop-stress counts the instructions of its steps by Valgrind, the same in every run.
set -euo pipefail
stress=$1 write_synthetic_models=$2
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
"$write_synthetic_models" "$folder"

count() {
  "$stress" "$folder/sphere_2_lifted_linear.gloop" --contacts 4 --cycles 260 --instructions --json
}

figures() {  # of the ratios and the heaviest step
  grep -E '"(instructions_max|least|median|most|p05|p95|steps)":' "$1"
}

count >"$folder/first.json"
count >"$folder/second.json"
diff <(figures "$folder/first.json") <(figures "$folder/second.json")
grep -qE '"instructions_max": [1-9][0-9]{3,},' "$folder/first.json"
grep -qE '"steps": 2[0-9]{2},?$' "$folder/first.json"
