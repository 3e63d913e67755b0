#!/usr/bin/env bash
# consume.sh SOURCE BUILD VIA VERSION MODEL: installs the package, then builds and runs the consumer against it.
# With MODEL = refuse the consumer's configuration has to fail, because VERSION is not to be had.
set -euo pipefail
source_dir=$1 build=$2 via=$3 version=$4 model=$5
work=$build/packaging/$via-$version
rm -rf "$work" && mkdir -p "$work"

# the examples of README.md (C++), docs/loop.md (C), docs/surface.md, touching.md and impulses.md are what the consumers
# compile
example() {  # example LANGUAGE DOCUMENT: its code in that language
  awk "/^\`\`\`$1\$/ {inside = 1; next} /^\`\`\`\$/ {inside = 0} inside" "$source_dir/$2"
}
loop_example_cpp=README.md loop_example_c=docs/loop.md
for language in cpp c; do
  for page in surface touching impulses; do
    example $language docs/$page.md >"$work/${page}_example.$language"
    test -s "$work/${page}_example.$language" || { echo "docs/$page.md has no $language block"; exit 1; }
  done
  page=loop_example_$language
  example $language "${!page}" >"$work/readme_example.$language"
  test -s "$work/readme_example.$language" || { echo "${!page} has no $language block"; exit 1; }
  # the same with room for the fields of small models alone
  sed -E 's/field\[(4 \* )?4096\]/field[\116]/' "$work/readme_example.$language" >"$work/readme_example_small.$language"
  grep -qE 'field\[(4 \* )?16\]' "$work/readme_example_small.$language"
done

# flags of a parent project that change arithmetic must not reach the library
flags=
if [ "$via" = add_subdirectory ]; then
  flags="-Ofast -ffast-math -ffinite-math-only -funsafe-math-optimizations"
  if c++ --version | grep -q 'Free Software'; then flags+=" -fsingle-precision-constant -frounding-math"; fi
fi

cmake --install "$build" --prefix "$work/prefix" --component runtime >/dev/null
configure() {
  PKG_CONFIG_PATH=$(dirname "$(find "$work/prefix" -name greenloop.pc)") cmake -S "$source_dir/rt_tests/packaging/consumer" \
    -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$work/prefix" -DCONSUMER_VIA="$via" \
    -DCMAKE_C_FLAGS="$flags" -DCMAKE_CXX_FLAGS="$flags" \
    -DWANTED_VERSION="$version" -DGREENLOOP_SOURCE="$source_dir" -DREADME_EXAMPLE="$work/readme_example" \
    -DSURFACE_EXAMPLE="$work/surface_example" -DTOUCHING_EXAMPLE="$work/touching_example" \
    -DIMPULSES_EXAMPLE="$work/impulses_example"
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
"$work/build/consumer" "$model" >"$work/forces.cpp.txt"
"$work/build/c_consumer" "$model" >"$work/forces.c.txt"
test "$(wc -l <"$work/forces.c.txt")" -eq 100
cmp "$work/forces.cpp.txt" "$work/forces.c.txt"
"$work/build/surface_consumer" "$model" >"$work/touched.cpp.txt"
"$work/build/c_surface_consumer" "$model" >"$work/touched.c.txt"
test "$(wc -l <"$work/touched.c.txt")" -gt 10
cmp "$work/touched.cpp.txt" "$work/touched.c.txt"
"$work/build/touching_consumer" "$model" >"$work/felt.cpp.txt"
"$work/build/c_touching_consumer" "$model" >"$work/felt.c.txt"
test "$(wc -l <"$work/felt.c.txt")" -eq 60
cmp "$work/felt.cpp.txt" "$work/felt.c.txt"
motion=$build/recorded_model/recorded_motion.gloop
"$work/build/impulses_consumer" "$motion" >"$work/shown.cpp.txt"
"$work/build/c_impulses_consumer" "$motion" >"$work/shown.c.txt"
test "$(wc -l <"$work/shown.c.txt")" -eq 200
cmp "$work/shown.cpp.txt" "$work/shown.c.txt"
for program in consumer_small c_consumer_small; do
  if "$work/build/$program" "$model" 2>"$work/$program.txt" >/dev/null; then exit 1; fi
  grep -q '^status 3 after 0 cycles' "$work/$program.txt"
done
if [ "$via" != find_package ]; then
  # a C compiler alone links it, without a C++ standard library
  export PKG_CONFIG_PATH
  PKG_CONFIG_PATH=$(dirname "$(find "$work/prefix" -name greenloop.pc)")
  # shellcheck disable=SC2046
  cc -std=c11 -Wall -Wextra -pedantic -Werror "$source_dir/rt_tests/packaging/consumer/main.c" "$work/readme_example.c" \
    $(pkg-config --cflags --libs greenloop) -o "$work/plain_c"
  "$work/plain_c" "$model" | cmp - "$work/forces.c.txt"
fi
