#!/usr/bin/env bash
# The libraries of the loop include nothing but their own headers and these.
set -euo pipefail
allowed='cassert cfloat climits cmath cstddef cstdint cstring limits new span algorithm array atomic bit type_traits utility'
allowed+=' immintrin.h'  # eight lanes at once, on x86-64 only: functions of the compiler, no library's
files=$(git ls-files --cached --others --exclude-standard 'runtime/*.[ch]pp' 'formats/*.[ch]pp' |
  grep -E '^runtime/|^formats/[^/]*$|^formats/(layout|view|ready|verify)/' | grep -vE '_test\.cpp$|/testing/|^runtime/hosted/')
[ -n "$files" ] || exit 1
used=$(grep -hoE '^ *# *include <[^>]+>' $files | sed -E 's/.*<(.*)>/\1/' | sort -u)
foreign=$(comm -23 <(echo "$used") <(printf '%s\n' $allowed | sort))
if [ -n "$foreign" ]; then
  printf 'headers not allowed in the loop: %s\n' "$(echo "$foreign" | tr '\n' ' ')"
  exit 1
fi
