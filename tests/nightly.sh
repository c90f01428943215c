#!/usr/bin/env bash
# What takes longer than ./test.sh may: the sanitizers over all test programs (threads: over those that have any), all faults, all ranges, hostile clients, fuzzing, coverage, and the systemd guest. One table at the end.
# Usage: tests/nightly.sh [--state FOLDER] [--fresh] [--table] [SHARD]...
#
# The shards are in tests/nightly_shards, each at most 150 minutes. What is done is kept in FOLDER (runs/nightly): interrupted, the next call goes on with the shard
# that was begun. Shards of another revision of the sources are not taken for this one's: --fresh forgets them. SHARD: only those of that name, or that begin with
# it; --table: only the table.
# Exit status: 0 when every shard passed, 1 otherwise.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
state=runs/nightly list=${LANTERNFISH_NIGHTLY_SHARDS:-tests/nightly_shards} fresh='' only_table='' wanted=()
while [ $# -gt 0 ]; do
  case $1 in
    --state) state=$2; shift ;;
    --fresh) fresh=yes ;;
    --table) only_table=yes ;;
    -*) sed -n '2,/^set/s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
    *) wanted+=("$1") ;;
  esac
  shift
done
[ -z "$fresh" ] || rm -rf "$state"
mkdir -p "$state"

# The sources that the results are of, as they are now. A page of the docs changes no result.
sources() { git ls-files -s -- ':!*.md' ':!docs' && git diff -- ':!*.md' ':!docs'; }
revision=$(git rev-parse HEAD >/dev/null 2>&1 && sources | sha256sum | cut -c1-12 || echo "no repository")
[ -e "$state/revision" ] || echo "$revision" >"$state/revision"
if [ "$(cat "$state/revision")" != "$revision" ]; then
  echo "nightly: $state has results of $(cat "$state/revision"), the sources are $revision. --fresh begins anew, --state FOLDER keeps both." >&2
  exit 2
fi

chosen() {
  [ ${#wanted[@]} -gt 0 ] || return 0
  local name
  for name in "${wanted[@]}"; do [[ $1 == "$name"* ]] && return 0; done
  return 1
}
result_of() { cat "$state/${1//\//of}.result" 2>/dev/null || true; }

run_shard() {
  local name=$1 minutes=$2 command=$3
  local base=$state/${name//\//of} status=0 begin=$SECONDS result
  mkdir -p "$base"
  echo "nightly: $name"
  timeout -k 30 $((minutes * ${LANTERNFISH_NIGHTLY_MINUTE_S:-60})) bash -c "${command//\{out\}/$base}" >"$base.log" 2>&1 </dev/null || status=$?
  case $status in
    0) result=passed ;;
    77) result=skipped ;;
    124 | 137)  # no result: the next call goes on with it
      echo "nightly: $name is over its $minutes minutes; the next call goes on with it" >&2
      return
      ;;
    *) result="FAILED ($status)" ;;
  esac
  # Written at the end and at once: an interrupted shard has no result.
  echo "$result | $(((SECONDS - begin + 59) / 60)) | $(tail -n 1 "$base.log" | tr '|\t' '/ ' | cut -c1-90)" >"$base.result.new"
  mv "$base.result.new" "$base.result"
}

mapfile -t shards < <(sed 's/#.*//' "$list" | awk 'NF > 2')
if [ -z "$only_table" ]; then
  for shard in "${shards[@]}"; do
    read -r name minutes command <<<"$shard"
    [ "$minutes" -le 150 ] || { echo "nightly: $name has $minutes minutes, 150 are allowed" >&2; exit 2; }
    chosen "$name" || continue
    [ -n "$(result_of "$name")" ] || run_shard "$name" "$minutes" "$command"
  done
fi

failed=0
echo "| shard | result | minutes | last line |"
echo "|---|---|---|---|"
for shard in "${shards[@]}"; do
  read -r name _ <<<"$shard"
  chosen "$name" || continue
  result=$(result_of "$name")
  echo "| $name | ${result:-not done | | } |"
  [[ $result == passed* ]] || failed=1
done
exit $failed
