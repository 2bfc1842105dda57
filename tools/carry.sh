#!/bin/sh
# Carries the current branch onto main (or the branch given): tools/carry.sh [main]
# If the other branch has no renaming commits, this is a rebase. A renaming commit (with a line "Renames: MAP", see
# tools/rename.sh) cannot be merged as text. So this script rebases the branch onto the commit before it, runs the map on
# each commit of the branch, and puts the results on top of the renaming commit. It makes the branch's own renaming
# commits again from their maps.
# After a conflict: resolve it, `git rebase --continue`, and run this again.
maps_of() {
    git log -1 --format='%(trailers:key=Renames,valueonly)' "$1" | grep .
}

# Runs the maps of commit $1 in the current folder, with the maps and the tool of that commit.
rename_as() {
    tool=$(mktemp -d) || return 1
    for map in $(maps_of "$1"); do
        mkdir -p "$(dirname "$map")" && git show "$1:$map" >"$map" || return 1
    done
    git show "$1:tools/rename.py" >"$tool/rename.py" 2>/dev/null || git show HEAD:tools/rename.py >"$tool/rename.py"
    # shellcheck disable=SC2046
    python3 "$tool/rename.py" -f $(maps_of "$1") >"$tool/out" 2>&1
    status=$?
    [ $status -eq 0 ] || cat "$tool/out" >&2
    rm -rf "$tool"
    return $status
}

case $1 in
--todo) # git's list of commits to pick: own renaming ones are made again
    while read -r verb commit rest; do
        if [ "$verb" = pick ] && [ -n "$(maps_of "$commit")" ]; then
            echo "exec sh '$CARRY' --redo $commit"
        else
            echo "$verb $commit $rest"
        fi
    done <"$2" >"$2.new"
    mv "$2.new" "$2"
    exit
    ;;
--redo)
    rename_as "$2" && git add -A && git commit -q -C "$2"
    exit
    ;;
esac

main=${1:-main}
top=$(git rev-parse --show-toplevel) && cd "$top" || exit 1
branch=$(git symbolic-ref --short HEAD) || { echo "carry: not on a branch" >&2; exit 1; }
[ -z "$(git status --porcelain -uno)" ] || { echo "carry: the tree has changes that are not committed" >&2; exit 1; }
work=$(mktemp -d) || exit 1
trap 'git worktree remove --force "$work/tree" 2>/dev/null; rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
cp "$0" "$work/carry.sh"
# A copy of this script edits the list of commits; it stays if a conflict ends this one.
CARRY=$(git rev-parse --git-path carry.sh)
case $CARRY in /*) ;; *) CARRY=$top/$CARRY ;; esac
export CARRY
cp "$0" "$CARRY"
before=$(git rev-parse HEAD)

rebase_to() {
    GIT_SEQUENCE_EDITOR="sh '$CARRY' --todo" git rebase -q -i "$1" && return
    echo "carry: resolve the conflict, git rebase --continue, and run this again (before: $before)" >&2
    exit 1
}

# The tree that the maps of commit $1 make from commit $2.
tree_of() {
    [ -d "$work/tree" ] || git worktree add -q --detach "$work/tree" "$2" || return 1
    (cd "$work/tree" && git checkout -q --detach "$2" && rename_as "$1" && git add -A && git write-tree && git reset -q --hard) |
        grep -E '^[0-9a-f]{40}$'
}

while :; do
    base=$(git merge-base HEAD "$main") || exit 1
    rename=
    for commit in $(git rev-list --reverse --first-parent "$base..$main"); do
        [ -n "$(maps_of "$commit")" ] && { rename=$commit; break; }
    done
    if [ -z "$rename" ]; then
        rebase_to "$main"
        break
    fi
    parent=$(git rev-parse "$rename^")
    [ "$base" = "$parent" ] || rebase_to "$parent"
    if [ "$(git rev-parse HEAD)" = "$parent" ]; then
        git merge -q --ff-only "$rename" || exit 1
        continue
    fi
    made=$(tree_of "$rename" "$parent") || exit 1
    [ "$made" = "$(git rev-parse "$rename^{tree}")" ] ||
        { echo "carry: $rename is not what its map makes of the commit before" >&2; git diff --stat "$made" "$rename" >&2; exit 1; }
    tip=$rename
    for commit in $(git rev-list --reverse "$parent..HEAD"); do
        made=$(tree_of "$rename" "$commit") || { echo "carry: the map fails on $commit" >&2; exit 1; }
        tip=$(git log -1 --format=%B "$commit" |
            GIT_AUTHOR_NAME=$(git log -1 --format=%an "$commit") GIT_AUTHOR_EMAIL=$(git log -1 --format=%ae "$commit") \
                GIT_AUTHOR_DATE=$(git log -1 --format=%aD "$commit") git commit-tree "$made" -p "$tip") || exit 1
    done
    git reset -q --hard "$tip" || exit 1
done
echo "carry: $branch is $(git rev-list --count "$main..HEAD") commits on $main ($(git rev-parse --short "$main"))"
