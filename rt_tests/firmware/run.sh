#!/usr/bin/env bash
# run.sh QEMU IMAGE ARGUMENT...: runs the firmware with an instruction clock; its exit status is the firmware's.
set -euo pipefail
qemu=$1 image=$2
shift 2
exec "$qemu" -M mps2-an500 -display none -monitor none -serial none -kernel "$image" -icount shift=0,sleep=off \
  -semihosting-config "enable=on,target=native,arg=firmware$(printf ',arg=%s' "$@")"
