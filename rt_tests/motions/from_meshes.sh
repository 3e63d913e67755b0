#!/usr/bin/env bash
# A flag that swings, as a series of meshes, becomes a model of motions that all programs take.
set -euo pipefail
greenloop=$1 loop=$2
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
cd "$folder"

# frame NAME IMPULSE STEP: a sheet of 6 by 6 vertices whose two lowest modes swing and die out
frame() {
  awk -v sign="$2" -v t="$3" 'BEGIN {
    pi = 3.14159265; decay = exp(-t / 12)
    for (i = 0; i < 6; ++i) for (j = 0; j < 6; ++j) {
      z = sign * 0.1 * decay * (sin(pi * i / 10) * sin(t / 3) + 0.4 * sin(pi * i / 5) * sin(t / 1.7) * (j / 5))
      printf "v %.7f %.7f %.7f\n", i / 5, j / 5, z
    }
    for (i = 0; i < 5; ++i) for (j = 1; j < 6; ++j) {
      a = 6 * i + j
      printf "f %d %d %d\nf %d %d %d\n", a, a + 6, a + 7, a, a + 7, a + 1
    }
  }' >"$1"
}
frame rest.obj 0 0
for t in $(seq 1 90); do
  frame "$(printf 'gust_%04d.obj' "$t")" 1 "$((t - 1))"
  frame "$(printf 'lull_%04d.obj' "$t")" -1 "$((t - 1))"
done

cat >series.toml <<'TOML'
rate = "60 Hz"
unit = "m"
rest = "rest.obj"

[[impulse]]
name = "gust"

[[impulse]]
name = "lull"
after = ["rest", "gust"]

[[orbit]]
impulse = "gust"
frames = "gust_%04d.obj"
first = 1
count = 90
at_rest = true

[[orbit]]
impulse = "lull"
frames = "lull_%04d.obj"
count = 90
first = 1
at_rest = true
TOML
cat >scene.toml <<'TOML'
[trajectories]
file = "flag.h5"

[accuracy]
truncation = 0.001
TOML

"$greenloop" convert series.toml -o flag.h5
"$greenloop" build scene.toml -o flag.gloop
"$greenloop" verify flag.gloop
"$greenloop" inspect flag.gloop --json >inspected.json
for key in '"kind": "impulse_response"' '"rank": 2' '"orbits": 3' '"name": "gust"' '"name": "lull"' '"vertices": 36'; do
  grep -q "$key" inspected.json || { echo "inspect --json lacks $key"; cat inspected.json; exit 1; }
done
"$loop" flag.gloop --script impulses --rate 1000 --seconds 5 --transport memq --trace trace.csv --json >run.json
grep -q '"verdict": "HELD"' run.json
"$greenloop" report flag.gloop --trace trace.csv --figures figures
for figure in frames rank size run; do test -s "figures/$figure.svg"; done
grep -q 'The run held its budget in every cycle' flag.html

# the same with colours in light
cat scene.toml - >lit.toml <<'TOML'

[appearance]
reflectance = [0.9, 0.5, 0.2]
rays = 64
states = 12

[[appearance.parts]]
box = [[0, 0, 0], [0.3, 1, 1]]
reflectance = [0.1, 0.2, 0.9]
TOML
"$greenloop" build lit.toml -o lit.gloop
"$greenloop" inspect lit.gloop --json >inspected.json
grep -q '"rank_appearance": [1-9]' inspected.json
"$greenloop" inspect lit.gloop >inspected.txt
grep -q 'appearance  ' inspected.txt
"$greenloop" verify lit.gloop
"$loop" lit.gloop --script impulses --rate 1000 --seconds 1 --transport memq --json >run.json
grep -q '"verdict": "HELD"' run.json
"$greenloop" report lit.gloop --figures lit_figures
test -s lit_figures/light.svg
grep -q 'In the evening sun' lit.html

# a series whose meshes are not there
rm gust_0050.obj
if "$greenloop" convert series.toml -o other.h5 2>error.txt; then exit 1; fi
grep -q gust_0050.obj error.txt
