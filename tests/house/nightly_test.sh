#!/usr/bin/env bash
# tests/nightly.sh with shards of this test's making: it goes on where it stopped, and its table tells of every shard.
set -euo pipefail
nightly=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)/nightly.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export LANTERNFISH_NIGHTLY_SHARDS=$work/shards LANTERNFISH_NIGHTLY_MINUTE_S=3
fail() { echo "$*" >&2; cat "$work/said" >&2; exit 1; }
# ends STATUS ARGUMENT...
ends() {
  local wanted=$1 status=0
  shift
  "$nightly" --state "$work/state" "$@" >"$work/said" 2>&1 || status=$?
  [ "$status" -eq "$wanted" ] || fail "ended with $status, not with $wanted"
}
cat >"$work/shards" <<SHARDS
# a comment
good        1  echo one >>$work/ran; echo well
second.1/2  1  echo two >>$work/ran; [ -e $work/mended ]
skips       1  echo three >>$work/ran; exit 77
SHARDS
ends 1
grep -q '^| good | passed | [01] | well |$' "$work/said" || fail "a shard that passed is not told"
grep -q '^| second.1/2 | FAILED (1)' "$work/said" || fail "a shard that failed is not told"
grep -q '^| skips | skipped' "$work/said" || fail "a skipped shard is not told"
[ "$(cat "$work/ran")" = $'one\ntwo\nthree' ] || fail "not each shard was run once"

# Begun and interrupted, a shard has no result: it alone is run again.
rm "$work"/state/second.1of2.result "$work"/state/skips.result
touch "$work/mended"
sed -i 's/exit 77/true/' "$work/shards"
ends 0
[ "$(cat "$work/ran")" = $'one\ntwo\nthree\ntwo\nthree' ] || fail "what was done is done again"
ends 0 --table
ends 0 good
! grep -q second "$work/said" || fail "another shard than the one that was asked for"

# One that takes more than its time goes on with the next call.
echo "long 1 mkdir -p {out}; [ -e {out}/again ] || { touch {out}/again; sleep 60; }; echo whole" >>"$work/shards"
ends 1 long
grep -q '^| long | not done' "$work/said" || fail "a shard over its time is told as done"
ends 0 long
grep -q '^| long | passed' "$work/said" || fail "a shard over its time is not gone on with"

sed -i /^long/d "$work/shards"
echo "0000" >"$work/state/revision"
ends 2
ends 0 --fresh
echo "slow 200 true" >>"$work/shards"
ends 2
echo "resumes and tells"
