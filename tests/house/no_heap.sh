#!/usr/bin/env bash
# Fails when a core library refers to the heap, to exceptions or to a throwing helper of the standard library. Usage: no_heap.sh LIBRARY...
set -euo pipefail
forbidden='^(malloc|calloc|realloc|free|_Zn[wa]m.*|_Zd[la]Pv.*|__cxa_throw|__cxa_allocate_exception|_ZSt.*__throw_.*)$'
status=0
for library in "$@"; do
  [ -s "$library" ] || { echo "$library: missing"; exit 1; }
  symbols=$(nm -u -P "$library" | awk '{print $1}' | grep -E "$forbidden" | sort -u || true)
  if [ -n "$symbols" ]; then
    echo "$library refers to: $symbols"
    status=1
  fi
done
[ $status -ne 0 ] || echo "no heap symbol in $# libraries"
exit $status
