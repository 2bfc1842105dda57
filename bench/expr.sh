#!/bin/sh
# Expressions that are recorded from Lua functions: time of an operation, speed compared with Lua, and Prospero.
# Usage: bench/expr.sh [MODEL.vm [ISA]]     (default ../shared/models/prospero.vm, the best instruction set)
cd "$(dirname "$0")/.." || exit 1
make -s build/release/bench/expr && build/release/bench/expr "$@"
