
# bash cuts walls=3 into three words; isoslice is asked about the whole one.
_isoslice() {
    local rest=$COMP_LINE whole=() word space i cword=0 typed=
    for ((i = 0; i < ${#COMP_WORDS[@]}; i++)); do
        word=${COMP_WORDS[i]}
        space=${rest%%[![:space:]]*}
        rest=${rest#"$space"}
        rest=${rest#"$word"}
        if [[ -n $space || $i -eq 0 || ${#whole[@]} -eq 0 ]]; then
            whole+=("$word")
        else
            whole[${#whole[@]}-1]+=$word
        fi
        if ((i == COMP_CWORD)); then
            cword=$((${#whole[@]} - 1))
            typed=${whole[cword]}
            # The cursor may stand within the word.
            if [[ -n $2 && $word == "$2"* ]]; then
                typed=${typed%"$word"}$2
            fi
        fi
    done
    local COMP_WORDS=("${whole[@]}") COMP_CWORD=$cword
    _clap_complete_isoslice "$1" "$typed" "${whole[cword - 1]}"
    if [[ $COMP_WORDBREAKS == *=* && $typed == *=* ]]; then
        COMPREPLY=("${COMPREPLY[@]#"${typed%"${typed##*=}"}"}")
    fi
}
if ((BASH_VERSINFO[0] > 4 || BASH_VERSINFO[0] == 4 && BASH_VERSINFO[1] >= 4)); then
    complete -o nospace -o bashdefault -o nosort -F _isoslice isoslice
else
    complete -o nospace -o bashdefault -F _isoslice isoslice
fi
