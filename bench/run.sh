#!/bin/sh
# make bench: every benchmark that can run on this machine, one after the other. Those that need a peer program or a
# folder of models are skipped with a message if it is missing.
cd "$(dirname "$0")" || exit 1
for script in ./*.sh; do
    [ "$script" = ./run.sh ] && continue
    echo "== $script"
    sh "$script" || echo "   $script ended with an error"
done
