#!/usr/bin/env bash
# docs.sh BUILD: what the pages name is there. Links and their headings resolve; every figure of the results has its command; programs,
# scripts, tests and options that commands name exist. BUILD is a configured folder, whose tests are asked for.
set -euo pipefail
build=$1
status=0
complain() {
  printf '%s\n' "$1"
  status=1
}
pages=$(git ls-files --cached --others --exclude-standard -- README.md 'docs/*.md' 'docs/**/*.md' | sort -u)

# "## Some heading, one" of GitHub's pages is #some-heading-one
anchors() {
  sed -n 's/^#\+ //p' "$1" | tr '[:upper:]' '[:lower:]' | sed 's/[^[:alnum:] _-]//g; s/ /-/g'
}

for page in $pages; do
  while read -r target; do
    case $target in http*://* | mailto:*) continue ;; esac
    file=$page
    [ -z "${target%%#*}" ] || file=$(dirname "$page")/${target%%#*}
    if [ ! -e "$file" ]; then
      complain "$page: nothing is at the link $target"
    elif [ "${target#*#}" != "$target" ] && ! anchors "$file" | grep -qxF -- "${target#*#}"; then
      complain "$page: no heading of $file is #${target#*#}"
    fi
  done < <(grep -oE '\]\([^) ]+\)' "$page" | sed 's/^](//; s/)$//')
done

# A table of figures ends in a column of commands or tests without an empty cell, or a command stands in the text before it.
bare=$(awk '
  function last(line, cells, count) { gsub(/\\\|/, " ", line); count = split(line, cells, "|"); gsub(/^ +| +$/, "", cells[count - 1]); return cells[count - 1] }
  FNR == 1 { command = table = 0 }
  /^#/ { command = 0 }
  !/^\|/ { table = 0 }
  /`[^`]*(greenloop|ctest|\.\/dev|\.sh)[^`]*`|^    .*greenloop/ { if (!/^\|/) command = 1 }
  /^\|/ {
    if (!table) { table = 1; named = last($0) ~ /^(command|test)$/; if (!named && !command) print FILENAME ":" FNR ": a table of figures without a command"; next }
    if (named && last($0) == "") print FILENAME ":" FNR ": a figure without a command"
  }' $(printf '%s\n' $pages | grep '^docs/results'))
[ -z "$bare" ] || complain "$bare"

# Commands: what stands in backticks and in indented blocks of the pages.
commands=$(for page in $pages; do
  grep -ohE '`[^`]+`' "$page" | tr -d '`' | sed 's/\\|/|/g'
  sed -n 's/^    //p' "$page"
done | sed 's#build/[a-z]*/bin/##g')
programs=$(git grep -hoE '(add_executable|greenloop_program)\([a-zA-Z_-]+' -- '*CMakeLists.txt' | sed 's/.*(//'; echo greenloop)
for program in $(grep -oE "^(greenloop-[a-z-]+|write_[a-z_]+ )" <<<"$commands" | sort -u); do
  grep -qxF -- "$program" <<<"$programs" || complain "no program is named $program"
done
for script in $(grep -oE '\brt_tests/[a-z_/]+\.sh' <<<"$commands" | sort -u); do
  [ -f "$script" ] || complain "no script is $script"
done
for command in $(sed -n 's/^\.\/dev \([a-z]*\).*/\1/p' <<<"$commands" | sort -u); do
  grep -qE "^  $command( |\))" dev || complain "./dev has no command $command"
done
tests=$(ctest --test-dir "$build" -N | sed -n 's/^ *Test *#[0-9]*: //p')
while read -r pattern; do
  for one in ${pattern//|/ }; do
    grep -qE -- "$one" <<<"$tests" || complain "no test is named $one"
  done
done < <(sed -nE "s/^ctest .*-R '?([^ ']+)'?.*/\1/p" <<<"$commands" | sort -u)
for option in $(grep -E '^(greenloop|greenloop-[a-z-]+) ' <<<"$commands" | grep -oE ' --[a-z][a-z-]+' | sort -u); do
  git grep -qE -- "\"([^\"]*,)?!?$option\b|$option\[" -- '*.cpp' '*.hpp' || complain "no program has the option $option"
done
exit $status
