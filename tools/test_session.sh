# Read by tools/test.sh and the watchdog of tools/test_steps.sh.

# Ends the process group $1 except process $2, with SIGKILL what has not ended after some seconds.
end_group() {
    rounds=0
    kill -s TERM -- "-$1" 2>/dev/null
    while group_works "$1" "$2" && [ $rounds -lt 120 ]; do
        [ $rounds -lt 100 ] || kill -s KILL -- "-$1" 2>/dev/null
        sleep 0.05
        rounds=$((rounds + 1))
    done
}

# Whether the process group $1 has a member besides process $2 that has not ended (Z: it was not waited for).
group_works() {
    for file in /proc/[0-9]*/stat; do
        read -r pid _ state _ group _ 2>/dev/null <"$file" || continue
        [ "$group" = "$1" ] && [ "$pid" != "$2" ] && [ "$state" != Z ] && return 0
    done
    return 1
}
