#!/usr/bin/env bash
# The top level is exactly the agreed one, no source file outgrows 500 lines, nothing is left unfinished.
set -euo pipefail
source "$(dirname "$0")/sources.sh"
status=0
top=$(git ls-files --cached --others --exclude-standard | cut -d/ -f1 | sort -u | grep -v '^\.' | tr '\n' ' ')
agreed='CMakeLists.txt CMakePresets.json LICENSE README.md dev docs formats offline rt_tests runtime sim_hw '
if [ "$top" != "$agreed" ]; then
  printf 'top level: %s\n   agreed: %s\n' "$top" "$agreed"
  status=1
fi
long=$(sources '*.hpp' '*.cpp' '*.h' '*.c' | xargs wc -l | awk '$1 > 500 && $2 != "total" {print $2 ": " $1 " lines"}')
if [ -n "$long" ]; then
  printf 'longer than 500 lines:\n%s\n' "$long"
  status=1
fi
words='to''do|fix''me|not imple''mented|place''holder'
if git grep -nIiE "$words" -- '*.cpp' '*.hpp' '*.c' '*.h' '*.txt' '*.sh'; then
  status=1
fi
exit $status
