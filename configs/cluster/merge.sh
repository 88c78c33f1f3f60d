#!/usr/bin/env bash
# After the array: merge.sh OUT. Puts the shards together and validates every table; ends as the worst of them.
set -euo pipefail
cd "$1"
"$GONIO" merge . -o .
worst=0
for table in *.exr; do
    case "$table" in *.realisations.exr) continue ;; esac
    "$GONIO" validate "$table" > "log/${table%.exr}.validate.txt" || { code=$?; [ "$code" -gt "$worst" ] && worst=$code; }
done
exit "$worst"
