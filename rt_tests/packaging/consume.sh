#!/usr/bin/env bash
# consume.sh SOURCE BUILD VIA VERSION MODEL: installs the package, then builds and runs the consumer against it.
# With MODEL = refuse the consumer's configuration has to fail, because VERSION is not to be had.
set -euo pipefail
source_dir=$1 build=$2 via=$3 version=$4 model=$5
work=$build/packaging/$via-$version
rm -rf "$work" && mkdir -p "$work"

# the README's example is what the consumer compiles
awk '/^```cpp$/ {inside = 1; next} /^```$/ {inside = 0} inside' "$source_dir/README.md" >"$work/readme_example.cpp"
test -s "$work/readme_example.cpp" || { echo "README.md has no cpp block"; exit 1; }

cmake --install "$build" --prefix "$work/prefix" --component runtime >/dev/null
configure() {
  PKG_CONFIG_PATH=$(dirname "$(find "$work/prefix" -name greenloop.pc)") cmake -S "$source_dir/rt_tests/packaging/consumer" \
    -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$work/prefix" -DCONSUMER_VIA="$via" \
    -DWANTED_VERSION="$version" -DGREENLOOP_SOURCE="$source_dir" -DREADME_EXAMPLE="$work/readme_example.cpp"
}
if [ "$model" = refuse ]; then
  if configure >"$work/configure.log" 2>&1; then
    echo "version $version was accepted"
    exit 1
  fi
  grep -qE "compatible with requested version|greenloop>=$version" "$work/configure.log"
  exit 0
fi
configure >/dev/null
cmake --build "$work/build"
"$work/build/consumer" "$model"
