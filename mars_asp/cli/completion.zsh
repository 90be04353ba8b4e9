#compdef mars-asp
# Completion of mars-asp for zsh.
_mars_asp() {
    local -a verbs
    verbs=(
@verbs@
    )
    if (( CURRENT == 2 )) || [[ $words[2] == help ]]; then
        _describe command verbs
        return
    fi
    local verb=$words[2]
    shift words
    (( CURRENT-- ))
    case $verb in
@words@
    esac
}
compdef _mars_asp mars-asp
