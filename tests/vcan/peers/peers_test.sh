#!/usr/bin/env bash
# The simulated hardware among strangers: python-can, candump, cansend and cangen on vcan0. peers_test.sh LANTERNFISH
# Served nodes answer them as CiA 301 and 402 have it, survive 6000 random frames, and end cleanly with a result.
set -euo pipefail
lanternfish=$1
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
out=$(mktemp -d)

"$lanternfish" serve buttons_only --can vcan0 --out "$out/serve" 2>"$out/serve.log" &
serve=$!
trap 'kill $serve 2>/dev/null || true' EXIT
for _ in $(seq 100); do
  grep -q "serving nodes" "$out/serve.log" && break
  kill -0 $serve || { cat "$out/serve.log" >&2; exit 1; }
  sleep 0.1
done

PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 "$here/python_can_peer.py" vcan0

# answered REQUEST ANSWER: cansend sends the one, and within a second candump hears the other.
answered() {
  stdbuf -oL candump -L -T 1000 "vcan0,${2%%#*}:7FF" >"$out/heard" &
  local dump=$!
  sleep 0.2
  cansend vcan0 "$1"
  for _ in $(seq 20); do
    grep -q "vcan0 $2" "$out/heard" && break
    sleep 0.05
  done
  kill $dump 2>/dev/null || true
  wait $dump 2>/dev/null || true
  grep -q "vcan0 $2" "$out/heard" || { echo "no $2 to $1; heard:"; cat "$out/heard"; exit 1; } >&2
  echo "  $1 is answered with $2"
}
echo "cansend and candump"
answered 601#4000100000000000 581#4300100092010200  # device type, expedited
answered 606#4000100000000000 586#4300100091010300
answered 602#A008100000000000 582#8008100001000405  # block upload is refused
answered 000#8203 703#00                            # reset communication: boot-up

echo "cangen: standard, extended and remote frames at random"
cangen vcan0 -g 0.2 -n 2000 -I r -L r -D r
cangen vcan0 -g 0.2 -n 2000 -e -I r -L r -D r
cangen vcan0 -g 0.2 -n 2000 -I r -R -L r
kill -0 $serve || { echo "serve did not survive" >&2; cat "$out/serve.log" >&2; exit 1; }
cansend vcan0 000#8100  # all reset, whatever random commands have done to them
sleep 0.5
for node in 1 2 3 4 5; do answered 60$node#4000100000000000 58$node#4300100092010200; done

kill -TERM $serve
status=0
wait $serve || status=$?
trap - EXIT
cat "$out/serve.log"
[ $status -eq 0 ] || { echo "serve ended with $status" >&2; exit 1; }
/usr/bin/python3 - "$out/serve" <<'CHECK'
import hashlib, json, pathlib, sys
run = pathlib.Path(sys.argv[1])
result = json.loads((run / "result.json").read_text())
assert result["nodes"] == "1, 2, 3, 4, 5, 6" and result["bus"]["received"] > 6000 and result["bus"]["send_failures"] == 0, result["bus"]
experiment = json.loads((run / "experiment.json").read_text())
digest = hashlib.sha256((run / "experiment.json").read_bytes()).hexdigest()
assert result["provenance"]["experiment"] == digest and experiment["served nodes"] == result["nodes"], experiment
assert result["provenance"]["command"].startswith("lanternfish serve buttons_only --seed 1 --can vcan0"), result["provenance"]
assert (run / "scenario.yaml").read_text().count("tasks:") == 1 and not pathlib.Path(f"{run}.writing").exists()
assert result["success"] is False and len(result["tasks"]) == 3, result["tasks"]
lines = (run / "can0.log").read_text().splitlines()
assert len(lines) == result["bus"]["received"] + result["bus"]["sent"], (len(lines), result["bus"])
print("SYNC answered:", result["bus"]["sync_answered_us"], "real time:", result["real_time"])
CHECK
