#!/bin/sh
# make test, make test-long: runs tools/test_steps.sh in a separate session, so that one signal reaches all processes. This
# process only waits for it. With SETUP=0 no package is installed, and what is missing is skipped. Ctrl-C, SIGTERM and SIGHUP are passed on; if this process or make ends for another reason,
# the session ends by itself.
cd "$(dirname "$0")/.." || exit 1
. tools/test_session.sh
[ "${SETUP:-}" = 0 ] || tools/setup.sh --tests || exit 1

end_by() {
    trap '' INT TERM HUP
    kill -s TERM "$steps" # it may not lead its group yet
    end_group "$steps"
    wait "$steps"
    trap - "$1"
    kill -s "$1" $$
}

made_by=
[ -z "$MAKELEVEL" ] || made_by=$PPID
setsid sh tools/test_steps.sh "$$" "$made_by" "$@" &
steps=$!
trap 'end_by INT' INT
trap 'end_by TERM' TERM
trap 'end_by HUP' HUP
wait "$steps"
