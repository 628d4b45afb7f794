#!/usr/bin/env bash
# The beginning of every task. It tells ecFlow that the task runs, and later that it was aborted, if it was.
set -euo pipefail
export ECF_PORT=%ECF_PORT% ECF_HOST=%ECF_HOST% ECF_NAME=%ECF_NAME% ECF_PASS=%ECF_PASS% ECF_TRYNO=%ECF_TRYNO%
export ECF_RID=$$ ECF_TIMEOUT=300
export PATH="$PATH:/usr/local/bin"

program=
# Runs once, if a command fails, a signal arrives, or the task exits before tail.h has completed it.
aborted() {
  local reason=$1
  trap - ERR EXIT TERM INT HUP
  if [ -n "$program" ]; then
    kill -TERM "$program" 2>/dev/null || true
    wait "$program" || true
  fi
  ecflow_client --abort="$reason"
  exit 1
}
trap 'aborted "exit code $?"' ERR EXIT
trap 'aborted "stopped by a signal"' TERM INT HUP

ecflow_client --init=$$
