# Completion of gray in bash: gray itself prints what may follow (gray --complete).
_gray() {
    local word=${COMP_WORDS[COMP_CWORD]} answer line
    mapfile -t answer < <("$1" --complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null)
    [ "$word" != = ] || word=
    COMPREPLY=()
    for line in "${answer[@]:1}"; do
        [[ ${line%%$'\t'*} != "$word"* ]] || COMPREPLY+=("${line%%$'\t'*}")
    done
    case ${answer[0]} in
    scenes) mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -f -- "$word" | grep -E '\.(lua|(glb|gltf|obj|ply|stl)(\.gz)?)$'; compgen -d -- "$word") ;;
    files) mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -f -- "$word") ;;
    folders) mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -d -- "$word") ;;
    esac
}
complete -o filenames -F _gray gray rt
