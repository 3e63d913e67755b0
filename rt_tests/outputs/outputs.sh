#!/usr/bin/env bash
# outputs.sh PROGRAMS: what all programs do with streams, files, names and exit statuses. As root it makes device nodes of
# its own, and never touches those of the machine.
set -uo pipefail
here=$(cd "$(dirname "$0")" && pwd)
source "$here/scene.sh"
programs=$(cd "$1" && pwd)
PATH=$programs:$PATH
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
cube . 1
expect 0 "a build" greenloop build cube.toml -o c.gloop
cp c.gloop reference.gloop

# progress that cannot be written stops nothing
build() { rm -f p.*; greenloop build cube.toml -o p.gloop; }
(build 2>/dev/full >/dev/null) || fail "progress on a full disk stops a build"
same p.gloop reference.gloop "progress on a full disk"
(build 2>&- >/dev/null) || fail "closed standard error stops a build"
same p.gloop reference.gloop "closed standard error"
(build 2> >(exec true) >/dev/null) || fail "a reader of progress that went away stops a build"
(build <&- 2>&- >&-)
[ $? -eq 1 ] || fail "a build whose result cannot be told is a success"
same p.gloop reference.gloop "all streams closed"

# results that cannot be written are errors
greenloop-loop c.gloop --seconds 0.2 --transport memq >/dev/null || fail "a short run does not hold"
for command in "greenloop inspect c.gloop" "greenloop inspect c.gloop --json" "greenloop verify c.gloop" \
  "greenloop verify c.gloop --json" "greenloop convert c.gloop -o r.gloopz" "greenloop report c.gloop --json" \
  "greenloop build cube.toml -o c.gloop" "greenloop build cube.toml -o c.gloop --json" "greenloop --help" \
  "greenloop --version" "greenloop build --help" "greenloop-loop c.gloop --seconds 0.2 --transport memq --json" \
  "greenloop-loop c.gloop --seconds 0.2 --transport memq" "greenloop-stress c.gloop --cycles 200" \
  "greenloop-stress c.gloop --cycles 200 --list-steps" "greenloop-replay --help"; do
  $command >/dev/full 2>err
  [ $? -eq 1 ] || fail "$command on a full disk is a success"
  says "standard output" "$command on a full disk"
  $command >&- 2>err
  [ $? -eq 1 ] || fail "$command with closed standard output is a success"
  $command 2>err | true
  [ "${PIPESTATUS[0]}" -lt 126 ] || fail "$command dies of a closed pipe"
done

# special files are written through, links are followed
mkfifo pipe
cat pipe >received &
expect 0 "a model into a pipe" greenloop build cube.toml -o pipe --store s.h5
wait $!
same received reference.gloop "a model through a pipe"
[ -p pipe ] || fail "the pipe is gone"
ln -s target.gloop link.gloop
expect 0 "a model through a link to nothing" greenloop build cube.toml -o link.gloop
same target.gloop reference.gloop "a link to nothing"
expect 0 "a model through a link" greenloop build cube.toml -o link.gloop --force
[ -L link.gloop ] || fail "the link is gone"
same target.gloop reference.gloop "a link"
if [ "$(id -u)" -eq 0 ] && mknod null c 1 3 2>/dev/null; then
  expect 0 "a model into a null device" greenloop build cube.toml -o null --store s.h5
  expect 0 "a report into a null device" greenloop report c.gloop -o null
  [ -c null ] || fail "the null device was replaced"
  mknod full.gloopz c 1 7
  expect 1 "a stream onto a full device" greenloop convert c.gloop -o full.gloopz
  says "No space left" "a stream onto a full device"
fi

# outputs that are inputs, the store, each other or another's are refused before any work
cp cube.toml toml.before
cp cube.obj obj.before
printf 'int control(void);\n' >controller.c
cp controller.c controller.before
ln cube.toml hard.toml
printf '{"precious": 1}' >mine.build.json
refused() {  # refused WHY COMMAND...
  local why=$1
  shift
  expect 1 "$*" "$@"
  says "$why" "$*"
}
refused "over the scene" greenloop build cube.toml -o cube.toml
refused "over the scene" greenloop build cube.toml -o hard.toml
refused "over the mesh" greenloop build cube.toml -o cube.obj
refused "over the mesh" greenloop build cube.toml -o n.gloop --store cube.obj --overwrite-store
refused "over the model" greenloop build cube.toml -o m.h5
refused "mine.build.json" greenloop build cube.toml -o mine.gloop
refused "controller.c" greenloop convert c.gloop -o controller.h
refused "over the input" greenloop convert c.gloop -o ./c.gloop --levels 1
refused "C can include no file" greenloop convert c.gloop -o 'x"y.h'
refused "over the model" greenloop-loop c.gloop --trace c.gloop
refused "over the trace" greenloop-loop c.gloop --trace t.csv --snapshot ./t.csv
refused "over the model" greenloop report c.gloop -o c.gloop
refused "where standard output goes" greenloop report c.gloop -o out
refused "No such file or directory; make its folder" greenloop build cube.toml -o nowhere/c.gloop
refused "No such file or directory" greenloop-loop c.gloop --trace nowhere/t.csv
refused "Is a directory" greenloop convert c.gloop -o .
ln -s around.gloop round.gloop
ln -s round.gloop around.gloop
refused "Too many levels of symbolic links" greenloop build cube.toml -o round.gloop
refused "File name too long" greenloop build cube.toml -o "$(printf 'a%.0s' {1..300}).gloop"
refused "no file, but" greenloop build pipe
same cube.toml toml.before "the scene"
same cube.obj obj.before "the mesh"
same c.gloop reference.gloop "the model"
same controller.c controller.before "a source of somebody else"
[ -e m.h5 ] && fail "a refused build left a store"
expect 0 "C source" greenloop convert c.gloop -o model.h
expect 0 "C source again" greenloop convert c.gloop -o model.h

# names that are not UTF-8, and what a terminal would obey
latin=$(printf 'b\344r')
cp c.gloop "$latin.gloop"
cp cube.toml "$latin.toml"
for command in "greenloop verify $latin.gloop --json" "greenloop report $latin.gloop --json" \
  "greenloop build $latin.toml --json" "greenloop inspect $latin.gloop --json" "greenloop convert $latin.gloop -o $latin.off" \
  "greenloop-stress $latin.gloop --cycles 200 --json" \
  "greenloop-loop $latin.gloop --seconds 0.2 --transport memq --trace $latin.csv --json"; do
  expect 0 "a name in Latin-1" $command
  iconv -f UTF-8 -t UTF-8 out >/dev/null 2>&1 || fail "$command prints what is not UTF-8"
done
[ -s "$latin.gloop" ] && [ -s "$latin.off" ] && [ -s "$latin.csv" ] || fail "files with names in Latin-1 are missing"
escape=$(printf 'e\033[31m\302\233')
cp c.gloop "$escape.gloop"
printf '[surface]\n"\\u001b[31mkey" = 1\n' >escape.toml
for command in "greenloop inspect $escape.gloop" "greenloop verify $escape.gloop" "greenloop verify $escape.none" \
  "greenloop build escape.toml" "greenloop-stress --help" "greenloop build $escape.toml" "greenloop inspect $escape.gloop --json"; do
  $command >out 2>err
  LC_ALL=C grep -qP '[\x00-\x08\x0b-\x1f\x7f]|\xc2[\x80-\x9f]' out err && fail "$command prints control bytes"
done

# one exit status for each kind of end (programs.sh tries them all)
expect 2 "no command" greenloop
expect 2 "an unknown command" greenloop frobnicate
expect 2 "a number that is none" greenloop-loop c.gloop --rate fast
expect 2 "a number out of range" greenloop-stress c.gloop --cycles 0
printf 'junk' >junk.gloop
for command in "greenloop inspect" "greenloop verify" "greenloop-stress" "greenloop-loop" "greenloop report"; do
  expect 1 "$command of junk" $command junk.gloop
done

# a resumed or repeated build gives the same bytes
expect 0 "a build again" greenloop build cube.toml -o c.gloop --force
same c.gloop reference.gloop "a build from the whole store"
greenloop inspect c.gloop --json >out
grep -q '"unknowns": 0' out && fail "the counts of the body are those of the last run"

# a damaged store is replaced when that is asked for, and the fault has its cause and its remedy
rm -f c.gloop
truncate -s 20000 c.h5
expect 1 "a truncated store" greenloop build cube.toml -o c.gloop
says "truncated" "a truncated store"
says "--overwrite-store" "a truncated store"
expect 0 "a truncated store is replaced" greenloop build cube.toml -o c.gloop --overwrite-store
same c.gloop reference.gloop "after a truncated store"
rm -f c.gloop
LC_ALL=C sed -i 's/format_version/fXrmat_version/' c.h5
expect 1 "a store without its version" greenloop build cube.toml -o c.gloop
says "--overwrite-store" "a store without its version"
printf 'no store' >c.h5
expect 0 "what is no store is replaced" greenloop build cube.toml -o c.gloop --overwrite-store
same c.gloop reference.gloop "after no store"
(
  failures=0
  exec 9<c.h5
  flock 9
  expect 1 "a store in use" greenloop build cube.toml -o c.gloop --force --overwrite-store
  says "another process uses it" "a store in use"
  exit "$failures"
) || failures=$((failures + $?))

# a run that is interrupted keeps its trace and tells its verdict
for signal in INT TERM; do
  rm -f i.csv
  (
    trap - INT
    exec greenloop-loop c.gloop --seconds 3600 --transport memq --trace i.csv >out 2>err
  ) &
  run=$!
  sleep 1
  kill -$signal $run
  wait $run
  status=$?
  [ $status -eq $((128 + $(kill -l $signal))) ] || fail "$signal ends a run with $status"
  [ "$(wc -l <i.csv)" -gt 1 ] || fail "$signal loses the trace"
  [ "$(tail -c 1 i.csv | od -An -c | tr -d ' ')" = '\n' ] || fail "$signal cuts a line of the trace"
  grep -q VIOLATED out || fail "$signal loses the verdict"
done
nothing_left "the whole"
finish
