# SPDX-License-Identifier: GPL-3.0-or-later
# Completion of haft and haft-laws for bash. Commands and options are read from --help itself, so
# that they are always those of the program installed.

# The words of a program's --help: its commands (two spaces, a name, more spaces) or its options.
_haft_words() {
    case $2 in
    commands) "$1" --help 2>/dev/null | sed -n '/^Commands:/,/^$/s/^  \([a-z][a-z]*\)  *.*/\1/p' ;;
    options) "$1" --help 2>/dev/null | grep -o -- '--[a-z][a-z-]*=\{0,1\}' ;;
    esac
}

# Folders that hold a case.yaml, or that may lead to one.
_haft_cases() {
    local folder
    compgen -d -- "$1" | while IFS= read -r folder; do
        [ -e "$folder/case.yaml" ] && printf '%s\n' "$folder" || printf '%s/\n' "$folder"
    done
}

_haft() {
    local program=$1 word=${COMP_WORDS[COMP_CWORD]} last=${COMP_WORDS[COMP_CWORD - 1]} before=0 i
    for ((i = 1; i < COMP_CWORD; i++)); do
        # bash splits --map=FILE at the sign
        [[ ${COMP_WORDS[i]} == [-=]* || ${COMP_WORDS[i - 1]} == = ]] || before=$((before + 1))
    done
    if [[ $word == = || $last == = ]]; then
        mapfile -t COMPREPLY < <(compgen -f -- "${word#=}")
        compopt -o filenames
    elif [[ $word == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$(_haft_words "$program" options)" -- "$word")
        [[ ${COMPREPLY[0]-} != *= ]] || compopt -o nospace
    elif ((before == 0)); then
        mapfile -t COMPREPLY < <(compgen -W "$(_haft_words "$program" commands)" -- "$word")
    else
        mapfile -t COMPREPLY < <(_haft_cases "$word")
        [[ ${COMPREPLY[0]-} != */ ]] || compopt -o nospace
        ((before == 1)) || compopt -o default
    fi
}
complete -F _haft haft haft-laws
