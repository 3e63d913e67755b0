#!/usr/bin/env bash
# set_prices.sh COLUMN PRICES.json LIST: writes the prices of a file of greenloop-calibrate into a column of
# runtime/price_list.h, x86_64 or cortex_m7, with three digits.
set -euo pipefail
column=$1 prices=$2 list=$3
case $column in
  x86_64) before='ROW\(%s, ' ;;
  cortex_m7) before='ROW\(%s, [0-9.e+-]+, ' ;;
  *) echo "set_prices.sh: no column $column" >&2 && exit 1 ;;
esac
script=$(sed -nE 's/^ *"(\w+)": ([0-9.e+-]+),?$/\1 \2/p' "$prices" | while read -r name price; do
  # shellcheck disable=SC2059
  printf "s/($before)[0-9.e+-]+/\\\\1%.3g/\n" "$name" "$price"
done)
sed -i -E "$script" "$list"
clang-format -i "$list"
