#!/usr/bin/env bash
# set_prices.sh COLUMN PRICES.json LIST: writes the prices of a file of greenloop-calibrate into a column of
# runtime/price_list.h, x86_64 or cortex_m7, with three digits.
set -euo pipefail
column=$1 prices=$2 list=$3
case $column in
  x86_64) others= ;;
  cortex_m7) others='[0-9.]+, ' ;;
  *) echo "set_prices.sh: no column $column" >&2 && exit 1 ;;
esac
script=$(sed -nE 's/^ *"(\w+)": ([0-9.e+-]+),?$/\1 \2/p' "$prices" | awk -v others="$others" '
  function rounded(price) {
    if (price < 100) return sprintf("%.3g", price)
    for (unit = 1; price / unit >= 1000;) unit *= 10
    return unit * int(price / unit + 0.5)
  }
  { printf "s/(ROW\\(%s, %s)[0-9.]+/\\1%s/\n", $1, others, rounded($2) }')
sed -i -E "$script" "$list"
clang-format -i "$list"
