#!/usr/bin/env bash
# symbols.sh NM LIBRARY...: everything the libraries of the loop need from elsewhere is on this list.
set -euo pipefail
nm=$1
shift
allowed='memcpy memset memmove memcmp bcmp _GLOBAL_OFFSET_TABLE_'
defined=$("$nm" --defined-only "$@" | awk 'NF == 3 {print $3}' | sort -u)
needed=$("$nm" --undefined-only "$@" | awk 'NF == 2 && $1 == "U" {print $2}' | sort -u)
[ -n "$defined" ] || { echo "no symbols in $*"; exit 1; }
foreign=$(comm -23 <(echo "$needed") <(printf '%s\n' $defined $allowed | sort -u))
if [ -n "$foreign" ]; then
  printf 'not allowed in the loop:\n%s\n' "$(echo "$foreign" | c++filt)"
  exit 1
fi
echo "needs only: $(comm -12 <(echo "$needed") <(printf '%s\n' $allowed | sort -u) | tr '\n' ' ')"
