#!/usr/bin/env bash
# text.sh SIZE RECORDED PERCENT LIBRARY...: code and constants of the loop's libraries are within PERCENT of the RECORDED
# bytes: growth is to be noticed, and meant.
set -euo pipefail
size=$1 recorded=$2 percent=$3
shift 3
bytes=$("$size" "$@" | awk '$1 ~ /^[0-9]+$/ {sum += $1} END {print sum}')
echo "text of the loop's libraries: $bytes bytes, recorded $recorded, margin $percent %"
awk -v bytes="$bytes" -v recorded="$recorded" -v percent="$percent" 'BEGIN {
  exit !(bytes <= recorded * (1 + percent / 100) && bytes >= recorded * (1 - percent / 100))}'
