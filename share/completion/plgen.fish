# SPDX-License-Identifier: MIT-0
# Completion for fish of plgen and plrun. What options there are, and what for, they say themselves (--help).

function __plgen_option --description 'Complete one option' --argument-names command name value help
    set -l how
    switch $name
        case scheme form
            set how -x -a (string replace -r '.*: *' '' -- $help)
        case explain
            set how -f -a 'json program'
        case real
            set how -x -a 'double float'
        case accuracy
            set how -x -a compensated
        case math
            set how -x -a own
        case loads
            set how -x -a 'exact remainder'
        case o depfile params input sweep a2l fmu page
            set how -r -F
        case plot
            test $command = plgen; and set how -x -a 'response poles modes frf campbell'; or set how -r -F
        case '*'
            string match -q -r '^ ' -- $value; and set how -x
    end
    if test (string length -- $name) -eq 1
        complete -c $command -s $name $how -d $help
    else
        complete -c $command -l $name $how -d $help
    end
end

for command in plgen plrun
    set -l lines ($command --help 2>/dev/null)
    # What plrun passes on to plgen, plgen explains
    for word in (string match -r '^  passed on.*' -- $lines | string match -r -a -- '--[a-z-]+')
        set -a lines (plgen --help 2>/dev/null | string match -r -- "^  $word .*")
    end
    complete -c $command -e
    complete -c $command -f -k -a '(__fish_complete_suffix .spec)'
    for line in $lines
        set -l part (string match -r '^  --?([A-Za-z][a-z0-9-]*)((?:[ =[][^ ]+)*) {2,}(.*)' -- $line)
        if set -q part[4]
            __plgen_option $command $part[2] "$part[3]" $part[4]
        else if string match -q -r '^  -' -- $line
            for word in (string match -r -a -- '(?<=-)[A-Za-z][a-z0-9-]*' $line)
                __plgen_option $command $word '' ''
            end
        end
    end
end
functions -e __plgen_option
