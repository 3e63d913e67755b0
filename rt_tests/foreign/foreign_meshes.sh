#!/usr/bin/env bash
# foreign_meshes.sh PROGRAMS FILE...: tries to make a model of every mesh, as it is and, where that is refused, of a wrap
# around it, and prints a row of a table for each: what came, in how many seconds of processor time, and the words of a
# refusal. Ends with the counts. SECONDS_EACH (300) bounds each build, LEVELS (3) is what the scenes ask for, OUT keeps
# models and messages.
set -uo pipefail
PATH=$(cd "$1" && pwd):$PATH
shift
seconds_each=${SECONDS_EACH:-300}
levels=${LEVELS:-3}
out=${OUT:-$(mktemp -d)}
mkdir -p "$out"
[ -n "${OUT:-}" ] || trap 'rm -rf "$out"' EXIT

# scene MESH KIND KEYS: a body of 20 cm that stands on its lowest 15 %.
scene() {
  printf '[%s]\nfile = "%s"\nsize = "20 cm"\n%s\n' "$2" "$1" "$3"
  printf '[remesh]\nlevels = %s\n' "$levels"
  printf '[material]\nyoung = "20 kPa"\npoisson = 0.4\n[[fixed]]\nbelow = 0.15\naxis = "z"\n'
}

# refusal MESSAGES: its first line, and the first defect of a list below it.
refusal() {
  awk '/^greenloop: / {
    sub(/^greenloop: [^:]*: /, "")
    text = $0
    if (getline > 0 && sub(/^  - /, "")) { sub(/[:;].*/, ""); text = text " " $0 }
    print text
    exit
  }' "$1" | tr '|' '/'
}

# attempt MESH NAME KIND KEYS: sets status, seconds and words.
attempt() {
  local TIMEFORMAT='%U %S'
  scene "$1" "$3" "$4" >"$out/$2.toml"
  { time (
    ulimit -t "$seconds_each"
    greenloop build "$out/$2.toml" -o "$out/$2.gloop" --overwrite-store --json >"$out/$2.json" 2>"$out/$2.err"
    echo $? >"$out/$2.status"
  ); } 2>"$out/$2.time"
  status=$(cat "$out/$2.status")
  seconds=$(awk '{ printf "%.0f", $1 + $2 }' "$out/$2.time")
  words=$(refusal "$out/$2.err")
  [ "$status" -lt 128 ] || words="longer than $seconds_each s"
  [ "$status" -ne 0 ] || words=
  rm -f "$out/$2.h5"
}

models=0 wrapped=0 refused=0
printf '| mesh | came | seconds | the refusal of it as it is |\n|---|---|---|---|\n'
for mesh in "$@"; do
  mesh=$(realpath "$mesh")
  name=$(basename "$mesh" | tr . _)
  kind=surface
  case "$mesh" in *.msh | *.mesh | *.meshb | *.vtu | *.node | *.veg) kind=volume ;; esac
  attempt "$mesh" "$name" "$kind" ""
  first=$words first_seconds=$seconds
  if [ "$status" -eq 0 ]; then
    came=model models=$((models + 1))
  else
    grep -q 'wrap = "auto"' "$out/$name.err" || first="$first (no wrap offered)"
    attempt "$mesh" "${name}_wrapped" surface 'wrap = "auto"'
    if [ "$status" -eq 0 ]; then
      came="model, wrapped" wrapped=$((wrapped + 1))
    else
      came="refused: $words" refused=$((refused + 1))
    fi
  fi
  printf '| %s | %s | %s, %s | %s |\n' "$(basename "$mesh")" "$came" "$first_seconds" "$seconds" "$first"
done
printf '\n%s models as they are, %s wrapped, %s refused\n' "$models" "$wrapped" "$refused"
