#!/usr/bin/env bash
# c_names.sh GREENLOOP MODEL CC CXX FOLDER: whatever the file is called, the C source made of a model compiles, and two of
# them link into one program.
set -euo pipefail
greenloop=$1 model=$2 cc=$3 cxx=$4 folder=$5
rm -rf "$folder" && mkdir -p "$folder" && cd "$folder"
names=(switch default register union class template main printf size_t a-b a_b a.b "a b" 3d _x a__b a a_size bear)
for name in "${names[@]}"; do
  "$greenloop" convert "$model" -o "$name.h" >/dev/null
  "$cc" -std=c11 -Wall -Wextra -Werror -c "$name.c" -o "$name.o"
  "$cxx" -std=c++20 -Wall -Wextra -Werror -fsyntax-only -x c++ "$name.h"
done
echo 'int main(void) { return 0; }' >program.c
"$cc" -std=c11 program.c ./*.o -o program
./program
