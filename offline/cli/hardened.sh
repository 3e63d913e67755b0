#!/usr/bin/env bash
# hardened.sh READELF PROGRAM...: each is position-independent, resolved and made read-only before it runs, and guards
# its stack; the first checks the lengths that the compiler knows (not every program has such).
set -euo pipefail
readelf=$1
shift
first=$1
status=0
for program in "$@"; do
  require() {  # require WHAT PATTERN OPTION...
    local what=$1 pattern=$2
    shift 2
    if ! LC_ALL=C "$readelf" "$@" "$program" | grep -E "$pattern" >/dev/null; then
      echo "$program: no $what"
      status=1
    fi
  }
  require "position-independent program" 'Type: +DYN' --wide --file-header
  require "read-only relocations" 'GNU_RELRO' --wide --program-headers
  require "relocation before it runs" '\(FLAGS_1\).*NOW' --wide --dynamic
  require "position-independent executable" '\(FLAGS_1\).*PIE' --wide --dynamic
  require "stack protector" '__stack_chk_fail' --wide --dyn-syms
  if [ "$program" = "$first" ]; then
    require "checked library functions" '__[a-z]+_chk@' --wide --dyn-syms
  fi
  if LC_ALL=C "$readelf" --wide --program-headers "$program" | grep -E "GNU_STACK.*RWE" >/dev/null; then
    echo "$program: its stack can be executed"
    status=1
  fi
done
exit $status
