#!/usr/bin/env bash
# Includes point downwards only: rt_tests > sim_hw, offline > runtime > formats.
set -euo pipefail
source "$(dirname "$0")/sources.sh"
status=0
forbid() {  # forbid FOLDER PATTERN [BUT]: no product file of FOLDER, those of BUT left out, has a header of PATTERN
  local found
  found=$(sources "$1/*.hpp" "$1/*.cpp" | grep -vE "_test\.cpp$|${3:-^$}" | xargs -r grep -nE "#include [\"<]($2)/" || true)
  if [ -n "$found" ]; then
    printf '%s must not include %s:\n%s\n' "$1" "$2" "$found"
    status=1
  fi
}
forbid formats 'runtime|offline|sim_hw|rt_tests'
forbid runtime 'offline|sim_hw|rt_tests|formats/(mesh|store)'
forbid runtime 'formats/(write|transport)' '^runtime/(hosted|testing)/'
forbid offline 'sim_hw|rt_tests'
forbid sim_hw 'offline|rt_tests|formats/(mesh|store)'
exit $status
