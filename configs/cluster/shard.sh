#!/usr/bin/env bash
# One task of the array: shard.sh CAMPAIGN SHARDS OUT PATCHES. Goes on from the checkpoint of an earlier try.
set -uo pipefail
campaign="$1" shards="$2" out="$3" patches="$4"
options=(--shard "$SLURM_ARRAY_TASK_ID/$shards" -o "$out" --resume --threads "${SLURM_CPUS_PER_TASK:-1}")
[ -n "$patches" ] && options+=(--patches "$patches")
"$GONIO" measure "$campaign" "${options[@]}" &
worker=$!
# The time is nearly over: the worker ends its block and writes a checkpoint.
trap 'kill -TERM "$worker"' TERM
wait "$worker"
code=$?
while kill -0 "$worker" 2> /dev/null; do
    wait "$worker"
    code=$?
done
# Stopped (130) or killed (above 128): once more from the checkpoint, ten times at most. Errors stay errors.
if [ "$code" -gt 128 ] && [ "${SLURM_RESTART_COUNT:-0}" -lt 10 ]; then
    scontrol requeue "${SLURM_ARRAY_JOB_ID}_${SLURM_ARRAY_TASK_ID}" && sleep 60
fi
exit "$code"
