#!/usr/bin/env bash
# first_model.sh SOURCE BUILD: does what docs/first_model.md says, with a generated body as the mesh of the reader's own.
set -euo pipefail
page=$1/docs/first_model.md build=$2
work=$build/packaging/first_model
rm -rf "$work" && mkdir -p "$work/part"
block() {  # block LANGUAGE: the page's blocks of it, one after the other
  awk "/^\`\`\`$1\$/ {inside = 1; next} /^\`\`\`\$/ {inside = 0} inside" "$page"
}
export HOME=$work PATH=$build/bin:$PATH
cmake --install "$build" --component runtime --prefix "$HOME/greenloop" >/dev/null
cd "$work/part"
write_body blob 3 blob.obj
# 80 mm
awk '/^v / {print $1, 40 * $2, 40 * $3, 40 * $4; next} {print}' blob.obj >large.obj
greenloop convert large.obj -o part.stl
# one wavelet, where the page's scene compares five
(block toml && printf '[compression]\nwavelet = "linear"\n') >part.toml
block cmake >CMakeLists.txt
block cpp >main.cpp
export CXXFLAGS="-Wall -Wextra -Wpedantic -Werror"
block sh | sed '1,/^cmake --install/d' >commands.sh
bash -ex commands.sh | tee printed.txt
test "$(grep -cE ' ms .* N$' printed.txt)" -eq 10
grep -q HELD printed.txt
test -s part.html
grep -q "greenloop_DIR:PATH=$HOME/greenloop/" build/CMakeCache.txt
# pressed in, it pushes back
grep -E '^ 500 ms' printed.txt | awk '{exit !($3 > 1.9 && $5 > 0)}'
