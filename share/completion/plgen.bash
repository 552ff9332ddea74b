# SPDX-License-Identifier: MIT-0
# Completion for bash of plgen and plrun. What options there are, and the names of schemes and forms, they say
# themselves (--help), so this does not grow old.

# The words behind an option in --help, from the line that begins with it
_plgen_words_of() {
    "$1" --help 2>/dev/null | sed -n "s/^  $2 .*: *\([a-z0-9][a-z0-9 -]*\)\$/\1/p"
}

_plgen() {
    local command=${COMP_WORDS[0]} current=${COMP_WORDS[COMP_CWORD]} before= options
    [ "$COMP_CWORD" -gt 1 ] && before=${COMP_WORDS[COMP_CWORD - 1]}
    COMPREPLY=()
    compopt -o filenames 2>/dev/null
    # bash splits --explain=json at the sign
    if [ "$current" = = ]; then
        before=${COMP_WORDS[COMP_CWORD - 1]} current=
    elif [ "$before" = = ]; then
        before=${COMP_WORDS[COMP_CWORD - 2]}
    fi
    case $before in
        --scheme | --form)
            mapfile -t COMPREPLY < <(compgen -W "$(_plgen_words_of plgen "$before")" -- "$current")
            return ;;
        --explain) mapfile -t COMPREPLY < <(compgen -W 'json program' -- "$current"); return ;;
        --real) mapfile -t COMPREPLY < <(compgen -W 'double float' -- "$current"); return ;;
        --accuracy) mapfile -t COMPREPLY < <(compgen -W 'compensated' -- "$current"); return ;;
        --math) mapfile -t COMPREPLY < <(compgen -W 'own' -- "$current"); return ;;
        --loads) mapfile -t COMPREPLY < <(compgen -W 'exact remainder' -- "$current"); return ;;
        --plot)
            if [ "${command##*/}" = plgen ]; then
                mapfile -t COMPREPLY < <(compgen -W 'response poles modes frf campbell' -- "$current")
            else
                mapfile -t COMPREPLY < <(compgen -f -- "$current")
            fi
            return ;;
        -o | --depfile | --params | --input | --sweep | --a2l | --fmu | --page)
            mapfile -t COMPREPLY < <(compgen -f -- "$current"); return ;;
        --step | --tolerance | --prefix | --modes | --rows | --refresh | --solution | --until | --every | --jobs | \
            --sensitivity | --tunable | --column | --time | --title | --size | -D) return ;;
    esac
    case $current in
        -*)
            options=$("$command" --help 2>/dev/null | sed -n '/^  /p' | grep -o -e '--*[a-zA-Z][a-z0-9-]*' |
                grep -x -e '--[a-z][a-z0-9-]*' -e '-[a-zA-Z]' | sort -u)
            mapfile -t COMPREPLY < <(compgen -W "$options" -- "$current") ;;
        *) mapfile -t COMPREPLY < <(compgen -f -X '!*.spec' -- "$current"; compgen -d -- "$current") ;;
    esac
}

complete -F _plgen plgen plrun
