#!/usr/bin/env bash
# fit_price_list.sh BUILD MODEL...: fits both tables of runtime/price_list.h to counted instructions and writes them into it:
# of x86-64 by synthetic bodies of all wavelets and the models given, of the Cortex-M7 by what the firmware of BUILD counts.
# BUILD: a release build (gcc, x86-64) of greenloop-calibrate, write_synthetic_models, recorded_model and firmware.
# Repeat after another build, until the prices stay as they are: what steps do follows from them.
set -euo pipefail
build=$(realpath "$1")
shift
here=$(dirname "$(realpath "$0")")
list=$here/../../runtime/price_list.h
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
write_synthetic_models=$(find "$build" -name write_synthetic_models -type f)
"$write_synthetic_models" "$folder"

"$build/bin/greenloop-calibrate" --instructions --contacts 12 "$folder"/sphere_3_*.gloop "$@" -o "$folder/x86_64.json"
bash "$here/set_prices.sh" x86_64 "$folder/x86_64.json" "$list"

firmware=$build/rt_tests/firmware
bash "$here/../firmware/run.sh" qemu-system-arm "$firmware/image/firmware" --steps 2>"$folder/costs.txt"
recorded=$build/recorded_model
"$build/bin/greenloop-calibrate" --costs "$folder/costs.txt" "$recorded"/recorded_{model,butterfly,equilibrated}.gloop \
  "$firmware"/body/{body,ready_body}_model.gloop -o "$folder/cortex_m7.json"
bash "$here/set_prices.sh" cortex_m7 "$folder/cortex_m7.json" "$list"
