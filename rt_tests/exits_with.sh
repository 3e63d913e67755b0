#!/usr/bin/env bash
# exits_with.sh CODE COMMAND...: for negative controls, which must fail for the reason they were made for.
code=$1
shift
"$@"
status=$?
[ "$status" -eq "$code" ] || {
  echo "exit status $status instead of $code"
  exit 1
}
