#!/usr/bin/env bash
# stack.sh BUILD CEILING: no function of the loop's libraries takes more than CEILING bytes of stack, and none an amount
# that is not known when it is compiled.
set -euo pipefail
usage=$(find "$1/runtime/CMakeFiles/greenloop_runtime.dir" "$1/formats/CMakeFiles/greenloop_formats.dir" -name '*.su')
[ -n "$usage" ] || { echo "no .su files in $1"; exit 1; }
awk -F '\t' -v ceiling="$2" '
  $2 > most {most = $2; where = $1}
  $2 > ceiling || $3 !~ /static|dynamic,bounded/ {print "too much stack: " $0; bad = 1}
  END {print "deepest: " most " bytes, " where; exit bad}' $usage
