# Completion of mars-asp for bash.
_mars_asp() {
    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}
    local verb= words= prefix= at
    local kinds="@kinds@"
    COMPREPLY=()
    for ((at = 1; at < COMP_CWORD; at++)); do
        case ${COMP_WORDS[at]} in
            @valued@)
                [[ ${COMP_WORDS[at+1]} == "=" ]] && ((at++))
                ((at++)) ;;
            -*) ;;
            *)
                verb=${COMP_WORDS[at]}
                break ;;
        esac
    done
    if [[ $word == "=" ]]; then
        word=
    elif [[ $before == "=" ]]; then
        before=${COMP_WORDS[COMP_CWORD-2]}
    fi
    case "$verb $before" in
@values@
        *)
            case $verb in
@words@
            esac ;;
    esac
    mapfile -t COMPREPLY < <(compgen -P "$prefix" -W "$words" -- "${word#"$prefix"}")
}
complete -o default -o bashdefault -F _mars_asp mars-asp
