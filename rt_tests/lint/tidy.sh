#!/usr/bin/env bash
# tidy.sh BUILD PATTERN...: clang-tidy over the compiled sources that match. A file is looked at again only when it, a header of ours
# or the configuration changed, so that a second run on the same build folder is quick.
set -euo pipefail
source "$(dirname "$0")/sources.sh"
build=$1
shift
stamps=$build/tidy
mkdir -p "$stamps"
headers=$(sources '*.hpp' .clang-tidy | xargs cat | sha256sum | cut -c1-16)

check() {
  local file=$1 stamp
  stamp=$stamps/$( (echo "$headers" && cat "$file") | sha256sum | cut -c1-32)
  [ -f "$stamp" ] && return
  clang-tidy -p "$build" --quiet "$file" 2>"$stamp.log" >&2 || {
    cat "$stamp.log"
    return 1
  }
  rm -f "$stamp.log"
  touch "$stamp"
}
export -f check
export build stamps headers
# only files the build compiles have a command to be checked with
sources "$@" | while read -r file; do
  if grep -q "\"file\": \".*/$file\"" "$build/compile_commands.json"; then echo "$file"; fi
done | xargs -P2 -I{} bash -c 'check {}'
