#!/bin/sh
# Measures the everyday problems: how often each is solved, how long that takes, how many steps the plans have and how far
# they drive, against the best that was ever seen (best.tsv).
#
#   usage: DARRT=path/to/darrt sh measure.sh [SEEDS] [NAME ...]          50 seeds and all problems of best.tsv by default
#
# The records go to everyday.jsonl in the current folder; the same command goes on where it was interrupted.
set -eu
darrt=${DARRT:-darrt}
here=$(cd "$(dirname "$0")" && pwd)
seeds=${1:-50}
[ $# -gt 0 ] && shift
[ $# -gt 0 ] || set -- $(awk -F'\t' '!/^#/ { print $1 }' "$here/best.tsv")
"$darrt" bench "$@" --seeds "$seeds" --jobs 1 --quiet --out everyday.jsonl
awk -F'\t' '
  function number(line, key,    at) {
    at = match(line, "\"" key "\":-?[0-9.e+-]+")
    return at ? substr(line, at + length(key) + 3, RLENGTH - length(key) - 3) + 0 : ""
  }
  # The value below which the share q of the n values of one problem lie; values[name, i] counts from 1.
  function quantile(values, name, n, q,    i, j, swap, at) {
    for (i = 2; i <= n; i++)
      for (j = i; j > 1 && values[name, j - 1] > values[name, j]; j--) {
        swap = values[name, j]; values[name, j] = values[name, j - 1]; values[name, j - 1] = swap
      }
    at = int(q * n + 0.999999)
    return n ? values[name, at < 1 ? 1 : at] : 0
  }
  FNR == NR { if (!/^#/) { best_steps[$1] = $2; best_m[$1] = $3 } next }
  {
    match($0, /"problem":"[^"]*"/); name = substr($0, RSTART + 11, RLENGTH - 12)
    if (!(name in runs)) order[++problems] = name
    runs[name]++
    if ($0 !~ /"solved":true/) next
    n = ++solved[name]
    seconds[name, n] = number($0, "total"); steps[name, n] = number($0, "steps"); drive[name, n] = number($0, "base_m")
  }
  END {
    printf "%-20s %9s %8s %8s %6s %6s %8s %8s\n", "problem", "solved", "median s", "95 % s", "steps", "best", "drive m", "best"
    for (p = 1; p <= problems; p++) {
      name = order[p]; n = solved[name] + 0
      printf "%-20s %3d of %2d %8.2f %8.2f %6.1f %6s %8.2f %8s\n", name, n, runs[name], quantile(seconds, name, n, 0.5),
        quantile(seconds, name, n, 0.95), quantile(steps, name, n, 0.5), best_steps[name], quantile(drive, name, n, 0.5), best_m[name]
    }
  }
' "$here/best.tsv" everyday.jsonl
