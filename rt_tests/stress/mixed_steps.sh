#!/usr/bin/env bash
# mixed_steps.sh BUILD FOLDER PIECES [MODEL...]: work units over counted instructions of mixed steps, and whether they meet the bar:
# 95 in 100 within 0.8 to 1.25, none below 0.67. Of x86-64 by synthetic bodies of all wavelets and the models given, PIECES runs each,
# of the Cortex-M7 by what the firmware of BUILD counts. BUILD: a release build (gcc, x86-64) of greenloop-stress,
# write_synthetic_models and firmware. What FOLDER has of an earlier run is not counted again, so a run may be ended and go on.
set -euo pipefail
build=$(realpath "$1") folder=$2 pieces=$3
shift 3
here=$(dirname "$(realpath "$0")")
mkdir -p "$folder/models"
[ -e "$folder/models/sphere_3_linear.gloop" ] || "$(find "$build" -name write_synthetic_models -type f)" "$folder/models"

# a file that is whole or not there: keep FILE COMMAND...
keep() {
  local file=$1
  shift
  [ -e "$file" ] || { "$@" >"$file.part" && mv "$file.part" "$file"; }
}

# of the n-th run on each model
count_x86_64() {
  local model
  for model in "$folder"/models/sphere_3_*.gloop "${@:2}"; do
    keep "$folder/$(basename "$model" .gloop).$1.json" "$build/bin/greenloop-stress" "$model" --contacts 8 \
      --cycles 2600 --seed $((40 + $1)) --instructions --json
  done
}

# says over_the_bar, 5, in its status where a model alone misses it
count_cortex_m7() {
  local status=0
  bash "$here/../firmware/run.sh" qemu-system-arm "$build/rt_tests/firmware/image/firmware" --priced --more 2>&1 || status=$?
  [ "$status" = 0 ] || [ "$status" = 5 ]
}

for ((piece = 1; piece <= pieces; ++piece)); do
  count_x86_64 "$piece" "$@"
done
keep "$folder/cortex_m7.txt" count_cortex_m7

{
  jq -r '.predicted_over_instructions | "x86-64 \(.steps) \(.within * .steps | round) \(.least) \(.most)"' "$folder"/*.json
  sed -nE 's|^units over instructions of ([0-9]+) steps: 0.8..1.25 of ([0-9]+), in hundredths least ([0-9]+), most ([0-9]+)$|\1 \2 \3 \4|p' \
    "$folder/cortex_m7.txt" | awk '{ print "Cortex-M7", $1, $2, $3 / 100, $4 / 100 }'
} | awk '
  { steps[$1] += $2; within[$1] += $3 }
  !($1 in least) || $4 < least[$1] { least[$1] = $4 }
  $5 > most[$1] { most[$1] = $5 }
  END {
    for (name in steps) {
      share = within[name] / steps[name]
      printf "%s: %d steps, %.2f %% within 0.8 to 1.25, least %.3f, most %.2f\n", name, steps[name], 100 * share, least[name], most[name]
      missed = missed || share < 0.95 || least[name] < 0.67
    }
    exit missed
  }'
