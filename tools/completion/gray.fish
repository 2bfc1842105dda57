# Completion of gray in fish: gray itself prints what may follow (gray --complete).
function __gray_complete
    set -l words (commandline -opc)
    set -l word (commandline -ct)
    set -l answer ($words[1] --complete $words[2..] "$word" 2>/dev/null)
    test (count $answer) -gt 0; or return
    printf '%s\n' $answer[2..]
    switch $answer[1]
        case scenes
            __fish_complete_path "$word" | string match -r '^.*(?:\.(?:lua|glb|gltf|obj|ply|stl)(?:\.gz)?|/)(?:\t.*)?$'
        case files
            __fish_complete_path "$word"
        case folders
            __fish_complete_directories "$word"
    end
end
complete -c gray -f -a '(__gray_complete)'
complete -c rt -w gray
