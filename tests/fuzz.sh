#!/usr/bin/env bash
# Builds the fuzz targets of tests/fuzz with Clang's libFuzzer and sanitizers, runs them one after the other, and prints a table.
# Usage: tests/fuzz.sh [--seconds N | --runs N | --wanted] [--seed N] [--keep] [TARGET...]     default: 60 seconds each of all targets
#   --wanted  as many runs of each as the nightly shard wants (the table `wanted` below), without sanitizers and value profile, which are several times as slow, but
#             with the library's assertions; the sanitizers then get every input that was kept for reaching something new, and a minute of changes of their own
#   --seed    of the changes (default 1): shards of one target take different ones
#   --keep    add to tests/fuzz/corpus up to 12 inputs of at most 400 bytes that reach code which the kept ones do not, 4 KB a target in all
# What is found stays in build/fuzz/corpus/TARGET from call to call; an input that ends a target in build/fuzz/crashes/TARGET-*.
# Exit status: 0 when no input ended a target; 77 without Clang.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
declare -A wanted=([operator_line]=10000000 [frame_ring]=10000000 [can_core]=10000000 [can_devices]=10000000
  [vehicle_yaml]=1000000 [scenario_yaml]=1000000 [scene_yaml]=1000000 [drive_yaml]=1000000 [small_yaml]=1000000 [robot_yaml]=1000000 [urdf]=1000000 [mechanism]=1000000 [mesh]=1000000
  [image_peaks]=100000 [image_marker]=100000 [cloud]=100000)
most_kept=4096
limit=(-max_total_time=60) seed=1 by_table='' keep='' targets=()
while [ $# -gt 0 ]; do
  case $1 in
    --seconds) limit=("-max_total_time=$2"); shift ;;
    --runs) limit=("-runs=$2"); shift ;;
    --seed) seed=$2; shift ;;
    --wanted) by_table=yes ;;
    --keep) keep=yes ;;
    -*) sed -n '2,/^set/s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
    *) [ -n "${wanted[$1]:-}" ] || { echo "fuzz: no target $1: ${!wanted[*]}" >&2; exit 2; }; targets+=("$1") ;;
  esac
  shift
done
[ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(printf '%s\n' "${!wanted[@]}" | sort)
command -v clang++-14 >/dev/null || { echo "fuzz: skipped, there is no clang++-14 (toolchain/setup.sh --tests)" >&2; exit 77; }

build=build/fuzz plain=build/fuzz-plain
mkdir -p "$build/crashes"
# build_targets PRESET
build_targets() {
  local log=$build/build-$1.log
  { toolchain/configure.sh "$1" && cmake --build --preset "$1" --target "${targets[@]/#/fuzz_}" -- --quiet; } >"$log" 2>&1 || { tail -n 40 "$log" >&2; exit 1; }
}
build_targets fuzz
[ -z "$by_table" ] || build_targets fuzz-plain

# The libraries of Debian are not instrumented: containers that cross to them look overflowed when they are not. The JSON and YAML libraries keep what
# they need until the end.
export ASAN_OPTIONS=detect_container_overflow=0:detect_stack_use_after_return=0:allocator_may_return_null=1:${ASAN_OPTIONS:-}
export UBSAN_OPTIONS=print_stacktrace=1:${UBSAN_OPTIONS:-}

# Words of the seeds, for the mutations of text. make_dictionary TARGET
make_dictionary() {
  cat "$build/tests/fuzz/seeds/$1"/* tests/fuzz/corpus/"$1"/* 2>/dev/null | grep -aoE '[A-Za-z_][A-Za-z0-9_]{2,24}:?' | sort -u | sed 's/.*/"&"/' >"$build/$1.dict" || true
}

# last_number LOG WORD: the number after the word's last occurrence.
last_number() { grep -aoE "$2 *[0-9]+" "$1" | tail -n 1 | grep -oE '[0-9]+$' || echo '?'; }

# runs_of LOG
runs_of() {
  local runs
  runs=$(last_number "$1" 'stat::number_of_executed_units:')
  [ "$runs" != '?' ] || runs=$(grep -aoE '^#[0-9]+' "$1" | tail -n 1 | tr -d '#' || true)
  echo "${runs:-0}"
}

# fuzz FOLDER LOG arguments...: changes of the corpus by the target's program in FOLDER.
fuzz() {
  local folder=$1 log=$2
  shift 2
  "$folder/tests/fuzz_$target" "$@" -seed="$seed" -max_len="$length" "${dictionary[@]}" -timeout=25 -rss_limit_mb=4096 -print_final_stats=1 \
    -artifact_prefix="$build/crashes/$target-" "$found" "$kept" "$build/tests/fuzz/seeds/$target" >"$log" 2>&1 </dev/null || status=1
}

status=0
echo "| target | runs | of them sanitized | seconds | edges | corpus | ended by |"
echo "|---|---|---|---|---|---|---|"
for target in "${targets[@]}"; do
  log=$build/$target.log found=$build/corpus/$target kept=tests/fuzz/corpus/$target
  mkdir -p "$found" "$kept"
  make_dictionary "$target"
  dictionary=()
  [ ! -s "$build/$target.dict" ] || dictionary=("-dict=$build/$target.dict")  # an empty one is refused
  length=4096
  [[ $target != urdf && $target != mechanism ]] || length=16384
  [[ $target != can_* && $target != frame_ring ]] || length=1024
  before=$(find "$build/crashes" -name "$target-*" | wc -l)
  begin=$SECONDS
  runs=0
  if [ -n "$by_table" ]; then
    fuzz "$plain" "$build/$target-plain.log" "-runs=${wanted[$target]}"
    runs=$(runs_of "$build/$target-plain.log")
    [ "$runs" -ge "${wanted[$target]}" ] || status=1
    # What was kept, so that the minute is for changes.
    fuzz "$build" "$build/$target-kept.log" -runs=0
  fi
  fuzz "$build" "$log" "${limit[@]}" -use_value_profile=1
  sanitized=$(runs_of "$log")
  runs=$((runs + sanitized))
  crashes=$(($(find "$build/crashes" -name "$target-*" | wc -l) - before))
  seconds=$((SECONDS - begin))
  echo "| $target | $runs | $sanitized | $seconds | $(last_number "$log" 'cov:') | $(find "$found" -type f | wc -l) | $crashes inputs |"
  if [ -n "$keep" ] && [ "$crashes" -eq 0 ]; then
    # Of the inputs that together cover all, longer ones do more.
    work=$(mktemp -d)
    "$build/tests/fuzz_$target" -set_cover_merge=1 "$work" "$kept" "$build/tests/fuzz/seeds/$target" "$found" >"$build/$target.merge.log" 2>&1 </dev/null
    room=$((most_kept - $(find "$kept" -type f -exec cat {} + | wc -c)))
    while read -r size file; do
      [ "$size" -le "$room" ] || continue
      [ -e "$kept/${file##*/}" ] || { cp "$file" "$kept/" && room=$((room - size)); }
    done < <(find "$work" -type f -size -401c -printf '%s %p\n' | sort -rn | head -n 12)
    rm -r "$work"
  fi
done
exit $status
