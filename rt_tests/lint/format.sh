#!/usr/bin/env bash
# Every source file is as clang-format with the project's configuration leaves it.
set -euo pipefail
source "$(dirname "$0")/sources.sh"
sources '*.hpp' '*.cpp' '*.h' '*.c' | xargs clang-format --dry-run -Werror
