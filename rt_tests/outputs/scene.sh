# What the tests of outputs share: a body that is built in a second, and words for what must be.
# shellcheck shell=bash
failures=0

cube() {  # cube FOLDER [LEVELS]: a mesh and its scene
  mkdir -p "$1"
  cat >"$1/cube.obj" <<'OBJ'
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
OBJ
  cat >"$1/cube.toml" <<TOML
[surface]
file = "cube.obj"
size = "10 cm"
[remesh]
levels = ${2:-1}
[material]
young = "20 kPa"
poisson = 0.4
[[fixed]]
below = 0.1
axis = "z"
[compression]
wavelet = "lifted linear"
TOML
}

fail() {
  printf 'FAILED: %s\n' "$*"
  failures=$((failures + 1))
}

expect() {  # expect STATUS WHAT COMMAND...: runs it with its output in the files out and err
  local wanted=$1 what=$2 status=0
  shift 2
  "$@" >out 2>err || status=$?
  if [ "$status" -ne "$wanted" ]; then
    fail "$what: exit status $status instead of $wanted"
    head -3 err
  fi
}

says() { grep -qF -- "$1" err || fail "$2: standard error does not say '$1' but '$(head -c 300 err)'"; }
same() { cmp -s "$1" "$2" || fail "$3: $1 and $2 differ"; }
nothing_left() {  # nothing_left WHAT: no half-written file here
  local left
  left=$(find . -name '*.part' -o -name '*.new' | head -3)
  [ -z "$left" ] || fail "$1: left behind: $left"
}

finish() {
  [ "$failures" -eq 0 ] && exit 0
  printf '%s failed\n' "$failures"
  exit 1
}
